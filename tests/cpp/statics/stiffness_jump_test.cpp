// Neighbouring halves of a rod whose stiffnesses are 1e6 apart. Scenes give a rod one section, so
// the elements of the model are scaled. References: Euler and Bernoulli's beam, for the deflection
// in closed form, for the frequency by cubic Hermite elements (Przemieniecki, Theory of Matrix
// Structural Analysis, sections 5.6 and 11.2), which this file assembles itself.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "der/building/builder.hpp"
#include "der/catalog/linear_solvers.hpp"
#include "der/catalog/steppers.hpp"
#include "der/core/constants.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/registry.hpp"
#include "der/simulation.hpp"
#include "der/solvers/linear_solver.hpp"
#include "der/statics/equilibrium.hpp"
#include "der/statics/modes.hpp"
#include "der/steppers/stepper.hpp"
#include "fitted_order.hpp"

namespace der::test {
namespace {

constexpr double kRatio = 1e6;
constexpr double kForce = 1e-4;
/// EA L^2/EI of the root and of a softer tip: stretching plays no part in the answers.
constexpr double kSlenderness = 1e6;

/// Bending stiffness of a rod of length 1, clamped at x = 0.
struct Halves {
  double root;  ///< for x < 1/2
  double tip;

  /// The cell of a node is half of one and half of the other at the middle.
  [[nodiscard]] double at(double x) const {
    if (std::abs(x - 0.5) < 1e-9) return 2.0 / (1.0 / root + 1.0 / tip);
    return x < 0.5 ? root : tip;
  }
};

void scale(PlanarBend<AngleCurvature>::Constants& c, double factor) {
  c.stiffness_per_length *= factor;
}
void scale(IsotropicBend<AngleCurvature>::Constants& c, double factor) {
  c.stiffness_per_length *= factor;
}
void scale(SpatialBend<AngleCurvature>::Constants& c, double factor) {
  c.vertex.bend_1 *= factor;
  c.vertex.bend_2 *= factor;
  c.vertex.twist *= factor;
}

/// Scales the plain elements of a kind; those at the clamp keep the stiffness of the scene.
template <class Kernel>
void scale_bends(const Halves& halves, Model& model) {
  auto& list = elements_of<Kernel>(*model.elements);
  const auto dim = static_cast<std::size_t>(model.dimension);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const double x = model.initial_positions[list.dofs[i][dim]];
    scale(list.constants[i], halves.at(x) / halves.root);
  }
}

/// A stiffer half keeps its EA: a larger one would hide bending forces in the rounding of tensions.
template <class Kernel>
void scale_stretches(const Halves& halves, Model& model) {
  auto& list = elements_of<Kernel>(*model.elements);
  const auto dim = static_cast<std::size_t>(model.dimension);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const double x = 0.5 * (model.initial_positions[list.dofs[i][0]] +
                            model.initial_positions[list.dofs[i][dim]]);
    list.constants[i].EA *= std::min(1.0, halves.at(x) / halves.root);
  }
}

/// A cantilever under a force across its tip; the scene's stiffness is that of the root.
struct Cantilever {
  Model model;
  Pattern pattern;
  LinearSolverChoice linear;
  Assembler assembler;

  Cantilever(const std::string& name, const Halves& halves, int edges, double force)
      : model(scaled(name, halves, edges, force)),
        pattern(build_pattern(model)),
        linear(make_linear_solver("banded", pattern)),
        assembler(model, linear.solver->layout()) {}

  static Model scaled(const std::string& name, const Halves& halves, int edges, double force) {
    const bool planar = name == "planar";
    const std::string third = planar ? "" : ", 0";
    const std::string twist = name == "spatial" ? fmt::format(", GJ: {}", halves.root) : "";
    Model model = build_model(
        Scenario::parse(
            fmt::format(
                "title: t\nmodel: {0}\nrods:\n  - {{name: rod, nodes: {1}, from: [0, 0{2}], "
                "to: [1, 0{2}], cross_section: {{stiffness: {{EA: {3}, EI: {4}{5}, "
                "mass_per_length: 1}}}}}}\n"
                "supports:\n  - {{rod: rod, at: start, clamp: true}}\n"
                "loads:\n  - point_force: {{rod: rod, at: end, force: [0, {6}{2}]}}\n"
                "time: {{duration: 1, step: 0.01}}\n",
                name, edges + 1, third, kSlenderness * halves.root, halves.root, twist, force))
            .scene());
    scale_bends<PlanarBend<AngleCurvature>>(halves, model);
    scale_bends<IsotropicBend<AngleCurvature>>(halves, model);
    scale_bends<SpatialBend<AngleCurvature>>(halves, model);
    scale_stretches<Stretch<2>>(halves, model);
    scale_stretches<Stretch<3>>(halves, model);
    return model;
  }

  [[nodiscard]] Mode lowest_mode() const {
    const Configuration drawn = configuration_of(model, initial_state(model));
    return vibration_modes(model, assembler, *linear.solver, drawn, 1).front();
  }

  [[nodiscard]] Index tip() const {
    return model.dofs.num_positions() - model.dimension + 1;  // its y
  }
};

/// The integral of (1 - x)^2/EI over both halves.
double deflection(const Halves& halves) {
  return kForce * (7.0 / 24.0 / halves.root + 1.0 / 24.0 / halves.tip);
}

/// Lowest natural frequency [rad/s] by `edges` beam elements, whose error is of order 4. In
/// extended precision: stiffnesses 1e6 apart cost double precision the fifth digit.
double lowest_frequency(const Halves& halves, int edges) {
  using Extended = long double;
  using Matrix = Eigen::Matrix<Extended, Eigen::Dynamic, Eigen::Dynamic>;
  const int size = 2 * (edges + 1);
  Matrix stiffness = Matrix::Zero(size, size);
  Matrix mass = stiffness;
  const Extended l = Extended(1) / edges;
  Eigen::Matrix<Extended, 4, 4> k;
  k << 12, 6 * l, -12, 6 * l, 6 * l, 4 * l * l, -6 * l, 2 * l * l, -12, -6 * l, 12, -6 * l, 6 * l,
      2 * l * l, -6 * l, 4 * l * l;
  Eigen::Matrix<Extended, 4, 4> m;
  m << 156, 22 * l, 54, -13 * l, 22 * l, 4 * l * l, 13 * l, -3 * l * l, 54, 13 * l, 156, -22 * l,
      -13 * l, -3 * l * l, -22 * l, 4 * l * l;
  for (int i = 0; i < edges; ++i) {
    const Extended EI = halves.at((i + 0.5) / edges);
    stiffness.block<4, 4>(2 * i, 2 * i) += EI / (l * l * l) * k;
    mass.block<4, 4>(2 * i, 2 * i) += l / 420 * m;
  }
  const int free = size - 2;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(
      mass.bottomRightCorner(free, free), stiffness.bottomRightCorner(free, free));
  return static_cast<double>(1 / std::sqrt(solver.eigenvalues()[free - 1]));
}

constexpr std::array<const char*, 3> kModels{"planar", "spatial_bend", "spatial"};
constexpr std::array<Halves, 2> kBoth{{{1.0, 1.0 / kRatio}, {1.0, kRatio}}};

}  // namespace

TEST_CASE("neighbouring stiffnesses 1e6 apart: deflection and frequency, of order 2") {
  for (const std::string name : kModels) {
    for (const Halves& halves : kBoth) {
      CAPTURE(name);
      CAPTURE(halves.tip);
      std::vector<double> lengths;
      std::vector<double> deflections;
      std::vector<double> frequencies;
      for (const int edges : {10, 20, 40}) {
        Cantilever rod(name, halves, edges, kForce);
        State state = initial_state(rod.model);
        REQUIRE_FALSE(
            find_equilibrium(rod.model, rod.assembler, *rod.linear.solver, {}, state).failed);
        const double found = state.positions[rod.tip()];
        const double frequency = 2.0 * kPi * rod.lowest_mode().frequency;
        lengths.push_back(1.0 / edges);
        // The soft half bends far under this force; linear theory holds for the stiff tip alone.
        deflections.push_back(std::abs(found / deflection(halves) - 1.0));
        frequencies.push_back(std::abs(frequency / lowest_frequency(halves, 20) - 1.0));
      }
      CAPTURE(deflections.back());
      CAPTURE(frequencies.back());
      if (halves.tip > halves.root) {
        CHECK(fitted_order(lengths, deflections) > 1.9);
        CHECK(deflections.back() < 1.0 / (40.0 * 40.0));
      }
      CHECK(fitted_order(lengths, frequencies) > 1.9);
      CHECK(frequencies.back() < 4.0 / (40.0 * 40.0));
    }
  }
}

TEST_CASE(
    "neighbouring stiffnesses 1e6 apart: a quarter of a vibration, by every implicit stepper") {
  constexpr int kSteps = 60;
  constexpr double kAmplitude = 1e-3;
  for (const std::string name : kModels) {
    for (const Halves& halves : kBoth) {
      Cantilever rod(name, halves, 10, 0.0);
      const Mode mode = rod.lowest_mode();
      const double dt = 0.25 / mode.frequency / kSteps;
      for (const StepperInfo& info : stepper_registry()) {
        if (!info.implicit || (rod.model.dimension == 3 && info.name == "energy_momentum"))
          continue;
        CAPTURE(name);
        CAPTURE(halves.tip);
        CAPTURE(info.name);
        const auto stepper =
            make_stepper(info.name, rod.model, rod.assembler, *rod.linear.solver, {});
        State state = initial_state(rod.model);
        state.positions += kAmplitude / mode.shape[rod.tip()] * mode.shape;
        for (int i = 0; i < kSteps; ++i) {
          REQUIRE(stepper->step(state, dt).outcome == StepOutcome::Done);
          state.time += dt;
        }
        // The phase is off by less than (w dt)^2, and the damping of some has no part in a zero.
        CHECK(std::abs(state.positions[rod.tip()]) < 2e-3 * kAmplitude);
      }
    }
  }
}

}  // namespace der::test
