// Order of convergence and conservation, for every stepper in the registry.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "der/core/error.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/simulation.hpp"
#include "der/steppers/stable_step.hpp"
#include "fitted_order.hpp"

namespace der::test {
namespace {

// A soft four-node rod in a viscous fluid: its left end is moved by a table, its right end is
// pulled by a force that grows with time, and it starts with a velocity. Large rotations and
// strains.
const char* const kDrivenRod = R"(
title: Driven rod
rods:
  - name: rod
    points: [[0, 0], [0.3, 0.05], [0.6, 0], [0.9, 0.1]]
    cross_section: {stiffness: {EA: 20, EI: 0.05, mass_per_length: 0.2}}
    initial_velocity: [[0, 0], [0.2, 0.5], [0, -0.4], [0.3, 0.6]]
    spheres:
      - {at: all, radius: 0.01, density: 1000}
supports:
  - {rod: rod, at: start, fix: [x], prescribe: {y: {times: [0, 1], values: [0, 0.4]}}}
loads:
  - gravity: [0, -9.81]
  - fluid: {density: 0, viscosity: 1}
  - damping: {coefficient: 0.1}
  - point_force: {rod: rod, at: end, force: {times: [0, 1], values: [[0, 0], [2, 4]]}}
time: {duration: 0.4, step: 0.01, integrator: implicit_euler}
)";

constexpr double kDuration = 0.4;

Vector final_positions(const std::string& integrator, int steps) {
  const std::string step = fmt::format("{}", kDuration / steps);
  Simulation simulation(Scenario::parse(kDrivenRod, "driven rod",
                                        {{"time.integrator", integrator},
                                         {"time.step", step},
                                         {"output.every", step},
                                         {"solver.residual_tolerance", "1e-11"},
                                         {"solver.step_tolerance", "1e-11"}}));
  for (int i = 0; i < steps; ++i) simulation.step();
  return simulation.state().positions;
}

const char* const kFreeRod = R"(
title: Free flight
rods:
  - name: rod
    points: [[0, 0], [0.25, 0.02], [0.5, 0], [0.75, 0.03], [1, 0]]
    cross_section: {stiffness: {EA: 50, EI: 0.1, mass_per_length: 0.3}}
    initial_velocity: [[0, 1], [0.4, 0], [0.1, -0.7], [0.3, 0.2], [0, 1.1]]
time: {duration: 1, step: 0.001, integrator: implicit_euler}
)";

/// The largest eigenvalue of M^-1 K at the state of a simulation [1/s^2].
double largest_eigenvalue(const Simulation& simulation) {
  const auto dense = [](const SymmetricMatrix& sparse) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(sparse.pattern.size, sparse.pattern.size);
    for (Index column = 0; column < sparse.pattern.size; ++column) {
      const auto first = static_cast<std::size_t>(column);
      for (Index k = sparse.pattern.outer[first]; k < sparse.pattern.outer[first + 1]; ++k) {
        matrix(sparse.pattern.inner[static_cast<std::size_t>(k)], column) = sparse.values[k];
      }
    }
    return matrix;  // the lower triangle, which is all that the solver reads
  };
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      dense(simulation.hessian()), dense(simulation.mass()), Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cwiseAbs().maxCoeff();
}

struct Momenta {
  Vec2 linear = Vec2::Zero();
  double angular = 0.0;
};

Momenta momenta(const Simulation& simulation) {
  Momenta result;
  const Model& model = simulation.model();
  const Vector momentum = model.mass.momentum(simulation.state().velocities);
  for (Index node = 0; node < model.num_nodes; ++node) {
    const Vec2 x = simulation.state().positions.segment<2>(2 * node);
    const Vec2 p = momentum.segment<2>(2 * node);
    result.linear += p;
    result.angular += cross(x, p);
  }
  return result;
}

}  // namespace

TEST_CASE("every stepper converges at its stated order") {
  // The reference is of order 4, in steps at least 3 times smaller than those tested. That unlike
  // methods, an explicit one among them, agree with it is part of the test.
  const Vector reference = final_positions("sdirk4", 4800);
  const auto off = [&](const char* integrator, int steps) {
    return (final_positions(integrator, steps) - reference).lpNorm<Eigen::Infinity>();
  };
  REQUIRE(off("implicit_midpoint", 12800) < 5e-8);
  REQUIRE(off("verlet", 12800) < 5e-8);
  REQUIRE(off("sdirk5", 1600) < 1e-13);

  const std::map<int, std::vector<int>> counts = {
      {1, {1600, 3200, 6400}}, {2, {400, 800, 1600}}, {4, {50, 70, 100}}, {5, {400, 480, 560}}};
  for (const StepperInfo& info : stepper_registry()) {
    CAPTURE(info.name);
    std::vector<double> steps;
    std::vector<double> errors;
    for (const int count : counts.at(info.order)) {
      steps.push_back(kDuration / count);
      errors.push_back(
          (final_positions(std::string(info.name), count) - reference).lpNorm<Eigen::Infinity>());
      CAPTURE(errors.back());
    }
    CHECK(fitted_order(steps, errors) == doctest::Approx(info.order).epsilon(0.1 / info.order));
  }
}

TEST_CASE("free flight keeps the momenta that a stepper promises to keep, in steps of any length") {
  constexpr int kSteps = 5000;  // or to the end
  for (const StepperInfo& info : stepper_registry()) {
    for (const char* step : {"1e-3", "1e-4", "1e-5", "1e-6", "1e-7"}) {
      CAPTURE(info.name);
      CAPTURE(step);
      Simulation simulation(Scenario::parse(kFreeRod, "free flight",
                                            {{"time.integrator", std::string(info.name)},
                                             {"time.step", step},
                                             {"output.every", step},
                                             {"solver.residual_tolerance", "1e-13"},
                                             {"solver.step_tolerance", "1e-13"}}));
      const Momenta start = momenta(simulation);
      for (int i = 0; i < kSteps && !simulation.finished(); ++i) simulation.step();
      const Momenta end = momenta(simulation);
      CHECK((end.linear - start.linear).norm() < 1e-10 * start.linear.norm());
      if (info.keeps_angular_momentum) {
        CHECK(std::abs(end.angular - start.angular) < 1e-10 * std::abs(start.angular));
      }
    }
  }
}

TEST_CASE("a state restored goes on bit for bit") {
  for (const StepperInfo& info : stepper_registry()) {
    CAPTURE(info.name);
    Simulation simulation(
        Scenario::parse(kFreeRod, "free flight", {{"time.integrator", std::string(info.name)}}));
    for (int i = 0; i < 5; ++i) simulation.step();
    const State saved = simulation.state();
    for (int i = 0; i < 5; ++i) simulation.step();
    const Vector first = simulation.state().positions;
    simulation.restore(saved);
    for (int i = 0; i < 5; ++i) simulation.step();
    CHECK(first == simulation.state().positions);
  }
}

TEST_CASE("an explicit step above the stable one is refused, or diverges if the scene insists") {
  const auto driven = [](const std::string& integrator, const std::string& step,
                         const std::string& allow_unstable) {
    return Scenario::parse(kDrivenRod, "driven rod",
                           {{"time.integrator", integrator},
                            {"time.step", step},
                            {"time.duration", "10"},
                            {"time.allow_unstable", allow_unstable}});
  };
  CHECK_THROWS_WITH_AS(Simulation(driven("explicit_euler", "0.1", "false")),
                       doctest::Contains("which stretch at node 2 of rod 'rod' (x) sets"), Error);
  Simulation simulation(driven("explicit_euler", "0.1", "true"));
  const auto run = [&] {
    while (!simulation.finished()) simulation.step();
  };
  CHECK_THROWS_WITH_AS(run(), doctest::Contains("above the stable step"), DivergedError);
}

TEST_CASE("an explicit stepper picks a step that is stable and fits the frames") {
  for (const StepperInfo& info : stepper_registry()) {
    if (info.implicit) continue;
    CAPTURE(info.name);
    Simulation simulation(Scenario::parse(kFreeRod, "free flight",
                                          {{"time.integrator", std::string(info.name)},
                                           {"time.step", "auto"},
                                           {"output.every", "0.3"}}));
    const StepPlan& plan = simulation.plan();
    const StableStep stable = stable_step(simulation.model(), simulation.model().initial_positions,
                                          info.drag_limits_step);
    CHECK(plan.step <= 0.9 * stable.step);
    CHECK(plan.step * static_cast<double>(plan.steps_per_frame) == doctest::Approx(0.3));
    while (!simulation.finished()) simulation.step();
    CHECK(simulation.state().time == 1.0);
  }
}

TEST_CASE("the stable step is near that of the fastest mode, however the rod is bent and turned") {
  // The reference solves the whole eigenvalue problem.
  for (const double r : {0.01, 0.1, 0.4}) {  // bending stiffer than stretching in the last two
    CAPTURE(r);
    for (const double turn : {0.0, 0.39, 0.79, 2.0}) {
      CAPTURE(turn);
      for (const double bend : {0.0, 0.3, 2.0}) {
        CAPTURE(bend);
        for (const double squeeze : {1.0, 0.7, 1.3}) {
          CAPTURE(squeeze);
          Simulation simulation(Scenario::parse(fmt::format(R"(
title: Even chain
rods:
  - name: rod
    nodes: 16
    from: [0, 0]
    to: [1, 0]
    cross_section: {{circle: {{radius: {}}}}}
    material: {{youngs_modulus: 1e6, density: 1000}}
time: {{duration: 1, step: auto, integrator: verlet}}
)",
                                                            r),
                                                "chain"));
          State& state = simulation.state();
          const auto edges = static_cast<double>(simulation.model().num_nodes - 1);
          Vec2 place = Vec2::Zero();
          for (Index node = 0; node < simulation.model().num_nodes; ++node) {
            state.positions.segment<2>(2 * node) = place;
            const double angle = turn + bend * node / edges;
            place += squeeze / edges * Vec2{std::cos(angle), std::sin(angle)};
          }
          const double reference = 2.0 / std::sqrt(largest_eigenvalue(simulation));
          const double step = stable_step(simulation.model(), state.positions, false).step;
          CHECK(step <= reference * (1.0 + 1e-9));
          CHECK(step >= 0.85 * reference);
        }
      }
    }
  }
}

TEST_CASE("the stable step is where the motion starts to blow up") {
  // A straight rod, stretched by a little: its axial modes, up to the highest one. Verlet is stable
  // for dt w <= 2 and grows without bound beyond.
  const char* const text = R"(
title: Axial waves
rods:
  - name: rod
    nodes: 41
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 100, EI: 1e-6, mass_per_length: 1}}
    initial_velocity: [0.01, 0]
supports:
  - {rod: rod, at: end, fix: [x, y]}
time: {duration: 4, step: auto, integrator: verlet}
)";
  const StableStep stable = [&] {
    Simulation simulation(Scenario::parse(text, "waves"));
    return stable_step(simulation.model(), simulation.model().initial_positions, false);
  }();
  CHECK(stable.limited_by == "stretch");
  const auto blows_up = [&](double step) {
    Simulation simulation(Scenario::parse(text, "waves",
                                          {{"time.step", fmt::format("{}", step)},
                                           {"time.allow_unstable", "true"},
                                           {"output.every", fmt::format("{}", step)}}));
    try {
      while (!simulation.finished()) simulation.step();
    } catch (const DivergedError&) {
      return true;
    }
    return false;
  };
  CHECK_FALSE(blows_up(0.999 * stable.step));
  // Gershgorin's bound is a few per cent on the safe side.
  CHECK(blows_up(1.1 * stable.step));
}

}  // namespace der::test
