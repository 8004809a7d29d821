// Order of convergence and conservation, for every stepper in the registry.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "der/core/error.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/simulation.hpp"

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

/// Slope of log(error) against log(step) by least squares.
double fitted_order(const std::vector<double>& steps, const std::vector<double>& errors) {
  double sx = 0.0;
  double sy = 0.0;
  double sxx = 0.0;
  double sxy = 0.0;
  const auto n = static_cast<double>(steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double x = std::log(steps[i]);
    const double y = std::log(errors[i]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
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
  // The reference is the mean of two unlike second-order methods, an implicit and an explicit one,
  // at a step 8 times smaller than the finest one tested; that they agree is part of the test.
  const Vector midpoint = final_positions("implicit_midpoint", 12800);
  const Vector verlet = final_positions("verlet", 12800);
  REQUIRE((midpoint - verlet).lpNorm<Eigen::Infinity>() < 5e-8);
  const Vector reference = 0.5 * (midpoint + verlet);

  const std::map<int, std::vector<int>> counts = {{1, {1600, 3200, 6400}}, {2, {400, 800, 1600}}};
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

TEST_CASE("free flight keeps the momenta that a stepper promises to keep") {
  for (const StepperInfo& info : stepper_registry()) {
    CAPTURE(info.name);
    Simulation simulation(Scenario::parse(kFreeRod, "free flight",
                                          {{"time.integrator", std::string(info.name)},
                                           {"solver.residual_tolerance", "1e-12"},
                                           {"solver.step_tolerance", "1e-13"}}));
    const Momenta start = momenta(simulation);
    while (!simulation.finished()) simulation.step();
    const Momenta end = momenta(simulation);
    CHECK((end.linear - start.linear).norm() < 1e-10 * start.linear.norm());
    if (info.keeps_angular_momentum) {
      CHECK(std::abs(end.angular - start.angular) < 1e-10 * std::abs(start.angular));
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

TEST_CASE("an unstable explicit step is named as such") {
  Simulation simulation(Scenario::parse(
      kDrivenRod, "driven rod",
      {{"time.integrator", "explicit_euler"}, {"time.step", "0.1"}, {"time.duration", "10"}}));
  const auto run = [&] {
    while (!simulation.finished()) simulation.step();
  };
  CHECK_THROWS_WITH_AS(run(), doctest::Contains("above the stable step"), DivergedError);
}

}  // namespace der::test
