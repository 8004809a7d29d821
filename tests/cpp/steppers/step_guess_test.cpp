// The guess from which steps begin that know accelerations: how many iterations it leaves.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "der/simulation.hpp"

namespace der::test {
namespace {

constexpr int kSteps = 100;
constexpr double kStiffness = 1e6;  // EA [N]
constexpr double kMassPerLength = 0.1;
constexpr int kEdges = 50;
// Angular frequency of a chain of equal masses and springs in its fastest motion, in which
// neighbours move against each other: 2 sqrt(k/m), k = EA/l and m = mu l.
const double kFastest = 2.0 * kEdges * std::sqrt(kStiffness / kMassPerLength);

/// A cantilever of 1 m under a load put on at once, in steps such that w dt is `fast`.
Counters run(const char* integrator, double fast) {
  const double step = fast / kFastest;
  Simulation simulation(Scenario::parse(
      fmt::format(R"(
title: Cantilever
rods:
  - name: arm
    nodes: {}
    from: [0, 0]
    to: [1, 0]
    cross_section: {{stiffness: {{EA: {}, EI: 1, mass_per_length: {}}}}}
supports:
  - {{rod: arm, at: start, clamp: true}}
loads:
  - point_force: {{rod: arm, at: end, force: [100, -5]}}
time: {{duration: {}, step: {}, integrator: {}}}
)",
                  kEdges + 1, kStiffness, kMassPerLength, kSteps * step, step, integrator),
      "cantilever"));
  while (!simulation.finished()) simulation.step();
  return simulation.counters();
}

}  // namespace

TEST_CASE("steps far longer than the fastest motion begin near their end") {
  // With the whole sum q + dt v + dt^2/2 a, newmark at 500 took 70 iterations a step and halved
  // every third step.
  for (const char* integrator : {"newmark", "generalized_alpha", "energy_momentum"}) {
    for (const double fast : {50.0, 500.0}) {
      CAPTURE(std::string(integrator));
      CAPTURE(fast);
      const Counters counters = run(integrator, fast);
      CHECK(counters.retried_steps == 0);
      CHECK(counters.newton_iterations <= 8 * kSteps);
    }
  }
}

TEST_CASE("steps that resolve the fastest motion are guessed by velocity and acceleration") {
  // At w dt = 1 this guess leaves one or two iterations; the start of the step, or the velocity
  // alone, leaves two.
  for (const char* integrator : {"newmark", "generalized_alpha"}) {
    CAPTURE(std::string(integrator));
    const Counters counters = run(integrator, 1.0);
    CHECK(counters.retried_steps == 0);
    CHECK(counters.newton_iterations < 7 * kSteps / 4);
  }
}

}  // namespace der::test
