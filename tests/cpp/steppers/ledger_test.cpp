// The energy ledger of every stepper in the registry, against works that are integrated over the
// recorded motion by formulas of their own: the trapezoidal rule over powers, of order 2. A work
// that a stepper accumulates at a wrong place or time does not come closer with the step.
// tests/validation/test_energy.py does the same from Python with more cases.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "der/kinematics/planar_edge.hpp"
#include "der/simulation.hpp"
#include "fitted_order.hpp"

namespace der::test {
namespace {

constexpr double kDuration = 0.4;   // [s]
constexpr double kAxial = 20.0;     // EA [N]
constexpr double kBending = 0.05;   // EI [N m^2]
constexpr double kLineMass = 0.2;   // [kg/m]
constexpr double kDrag = 0.2;       // [N s/m^2]
constexpr double kGravity = 9.81;   // [m/s^2]
constexpr double kSpeed = 0.2;      // of the support [m/s]
constexpr double kForceRate = 4.0;  // of the force on the end, along y [N/s]
constexpr std::size_t kNodes = 4;
constexpr std::size_t kEdges = kNodes - 1;

std::string driven_rod(const std::string& integrator, double step) {
  return fmt::format(R"(
rods:
  - name: rod
    points: [[0, 0], [0.3, 0.05], [0.6, 0], [0.9, 0.1]]
    cross_section: {{stiffness: {{EA: {}, EI: {}, mass_per_length: {}}}}}
supports:
  - {{rod: rod, at: start, fix: [x], prescribe: {{y: {{times: [0, 1], values: [0, {}]}}}}}}
loads:
  - gravity: [0, {}]
  - damping: {{coefficient: {}}}
  - point_force: {{rod: rod, at: end, force: {{times: [0, 1], values: [[0, 0], [0, {}]]}}}}
time: {{duration: {}, step: {}, integrator: {}}}
)",
                     kAxial, kBending, kLineMass, kSpeed, -kGravity, kDrag, kForceRate, kDuration,
                     step, integrator);
}

/// The energies and powers of the driven rod, from positions and velocities alone.
class DrivenRod {
 public:
  explicit DrivenRod(const Vector& drawn) {
    for (std::size_t e = 0; e < kEdges; ++e) {
      rest_length_[e] = edge(drawn, e).norm();
      half_[e] += 0.5 * rest_length_[e];
      half_[e + 1] += 0.5 * rest_length_[e];
    }
    for (std::size_t b = 0; b + 1 < kEdges; ++b) rest_angle_[b] = turning_angle(drawn, b);
  }

  [[nodiscard]] double kinetic(const Vector& v) const {
    double twice = 0.0;
    for (std::size_t i = 0; i < kNodes; ++i) {
      twice += kLineMass * half_[i] * node(v, i).squaredNorm();
    }
    // An edge between free nodes has the mass of a rigid bar.
    for (std::size_t e = 1; e < kEdges; ++e) {
      twice -= kLineMass * rest_length_[e] / 6.0 * (node(v, e + 1) - node(v, e)).squaredNorm();
    }
    return 0.5 * twice;
  }
  [[nodiscard]] double potential(const Vector& x) const {
    double energy = 0.0;
    for (std::size_t e = 0; e < kEdges; ++e) {
      const double strain = edge(x, e).norm() / rest_length_[e] - 1.0;
      energy += 0.5 * kAxial * strain * strain * rest_length_[e];
    }
    for (std::size_t b = 0; b + 1 < kEdges; ++b) {
      const double turned = turning_angle(x, b) - rest_angle_[b];
      energy += 0.5 * kBending * turned * turned / half_[b + 1];
    }
    for (std::size_t i = 0; i < kNodes; ++i) {
      energy += kGravity * kLineMass * half_[i] * node(x, i).y();
    }
    return energy;
  }
  /// Power [W] of the force on the end.
  static double load_power(double t, const Vector& v) { return kForceRate * t * node(v, 3).y(); }
  /// Power [W] that drag takes of the free nodes.
  [[nodiscard]] double free_drag_power(const Vector& v) const {
    double power = 0.0;
    for (std::size_t i = 1; i < kNodes; ++i) power += kDrag * half_[i] * node(v, i).squaredNorm();
    return power;
  }
  /// Power [W] that drag takes of the node that moves evenly.
  [[nodiscard]] double held_drag_power() const { return kDrag * half_[0] * kSpeed * kSpeed; }
  /// Kinetic energy [J] of that node, which the support gives it in the first step.
  [[nodiscard]] double held_kinetic() const { return 0.5 * kLineMass * half_[0] * kSpeed * kSpeed; }
  /// Power [W] of the support against the elements and the weight.
  [[nodiscard]] double support_power(Vector x) const {
    constexpr double kShift = 1e-4;  // [m]: slopes are right to 1e-12 N
    const double y = x[1];
    const auto change = [&](double shift) {
      x[1] = y + shift;
      const double above = potential(x);
      x[1] = y - shift;
      return (above - potential(x)) / (2.0 * shift);
    };
    return kSpeed * (4.0 * change(kShift) - change(2.0 * kShift)) / 3.0;
  }

 private:
  static Vec2 node(const Vector& x, std::size_t i) {
    return x.segment<2>(2 * static_cast<Index>(i));
  }
  static Vec2 edge(const Vector& x, std::size_t e) { return node(x, e + 1) - node(x, e); }
  static double turning_angle(const Vector& x, std::size_t b) {
    return angle_between(edge(x, b), edge(x, b + 1));
  }

  std::array<double, kEdges> rest_length_{};
  std::array<double, kEdges - 1> rest_angle_{};
  std::array<double, kNodes> half_{};  // of the edges beside a node [m]
};

/// The largest difference [J] of each work over a run between the ledger and the trapezoids.
/// `numerical` needs none: it is what the others leave of the energy.
struct Differences {
  double loads = 0.0;
  double drag = 0.0;
  double supports = 0.0;
  double solver = 0.0;  ///< work of the solver's residual itself
  double energy = 0.0;  ///< of the engine's energies to those of DrivenRod
};

Differences compare(const std::string& integrator, int steps) {
  const double step = kDuration / steps;
  Simulation simulation(Scenario::parse(driven_rod(integrator, step)));
  const DrivenRod rod(simulation.model().initial_positions);
  const auto total = [&](const State& state) {
    return rod.kinetic(state.velocities) + rod.potential(state.positions);
  };
  Differences largest;
  const auto enter = [](double& entry, double difference) {
    entry = std::max(entry, std::abs(difference));
  };
  double loads = 0.0;
  double drag = 0.0;
  double supports = 0.0;
  for (int i = 0; i < steps; ++i) {
    const State before = simulation.state();
    simulation.step();
    const State& now = simulation.state();
    const double half = 0.5 * (now.time - before.time);
    loads += half * (DrivenRod::load_power(before.time, before.velocities) +
                     DrivenRod::load_power(now.time, now.velocities));
    const double held_drag = 2.0 * half * rod.held_drag_power();
    drag += half * (rod.free_drag_power(before.velocities) + rod.free_drag_power(now.velocities)) +
            held_drag;
    supports += half * (rod.support_power(before.positions) + rod.support_power(now.positions)) +
                held_drag + (i == 0 ? rod.held_kinetic() : 0.0);
    enter(largest.energy, energies(simulation.model(), now).total() - total(now));
    enter(largest.loads, now.work.loads - loads);
    enter(largest.drag, now.work.drag - drag);
    enter(largest.supports, now.work.supports - supports);
    enter(largest.solver, now.work.solver);
  }
  return largest;
}

}  // namespace

TEST_CASE("the ledger of every stepper is that of its motion") {
  constexpr double kExchanged = 0.3;  // [J] in this run, of the order of the largest energy
  const std::vector<int> counts{400, 800, 1600};
  for (const StepperInfo& info : stepper_registry()) {
    CAPTURE(info.name);
    std::vector<double> steps;
    std::vector<double> loads;
    std::vector<double> drag;
    std::vector<double> supports;
    for (const int count : counts) {
      const Differences found = compare(std::string(info.name), count);
      CHECK(found.energy < 1e-12 * kExchanged);
      CHECK(found.solver < 1e-8 * kExchanged);
      steps.push_back(kDuration / count);
      loads.push_back(found.loads);
      drag.push_back(found.drag);
      supports.push_back(found.supports);
    }
    for (const auto* differences : {&loads, &drag, &supports}) {
      CAPTURE(loads.back());
      CAPTURE(drag.back());
      CAPTURE(supports.back());
      // A stepper may accumulate by the trapezoidal rule, too: the same to rounding.
      if (differences->front() < 1e-11 * kExchanged) continue;
      CHECK(fitted_order(steps, *differences) > std::min(info.order, 2) - 0.1);
    }
  }
}

}  // namespace der::test
