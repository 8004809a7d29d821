// What happens when a step is hard: line search, indefinite matrices, retries, and failures that
// say where and when.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "der/core/error.hpp"
#include "der/simulation.hpp"

namespace der::test {
namespace {

// A cantilever that a force against its axis, far above the buckling load, presses together.
const char* const kPressed = R"(
title: Pressed cantilever
rods:
  - name: rod
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1000, EI: 0.05, mass_per_length: 0.3}}
supports:
  - {rod: rod, at: start, clamp: true}
loads:
  - point_force: {rod: rod, at: end, force: [-20, 0.001]}
  - damping: {coefficient: 0.5}
time: {duration: 20, step: 0.05, integrator: implicit_euler}
)";

}  // namespace

TEST_CASE("an indefinite stiffness leads away from the straight rod, to a stable shape") {
  Simulation simulation(Scenario::parse(kPressed));
  while (!simulation.finished()) simulation.step();
  // Pulled through: the rod has turned round and hangs behind the clamp along the force.
  const Vector& x = simulation.state().positions;
  CHECK(x[x.size() - 2] < -0.8);
  CHECK(simulation.equilibrium().stability.unstable_directions == 0);
}

TEST_CASE("a step that cannot be solved is retried in smaller ones, then named") {
  // One iteration a step is enough for a small step only.
  Simulation simulation(Scenario::parse(
      kPressed, "scene", {{"solver.max_iterations", "1"}, {"time.minimum_step", "0.02"}}));
  std::string message;
  double last_good = -1.0;
  try {
    while (!simulation.finished()) {
      last_good = simulation.state().time;
      simulation.step();
    }
  } catch (const NotConvergedError& error) {
    message = error.what();
  }
  CHECK(message.find("a step from t = ") != std::string::npos);
  CHECK(message.find("of rod 'rod'") != std::string::npos);
  CHECK(simulation.counters().retried_steps > 0);
  CHECK(simulation.state().time == last_good);
  CHECK(simulation.state().positions.allFinite());
}

TEST_CASE("a retried step ends where a run with small steps ends") {
  // A gentle push across the axis: two iterations do not solve a step of 50 ms, but its pieces.
  // Each piece is at least as accurate as the whole step, which is off by 3e-4 m here.
  const auto end = [](const std::string& step, const std::string& iterations) {
    Simulation simulation(Scenario::parse(kPressed, "scene",
                                          {{"loads.0.point_force.force", "[0, 0.1]"},
                                           {"loads.1.damping.coefficient", "2"},
                                           {"time.step", step},
                                           {"time.duration", "0.6"},
                                           {"time.integrator", "tr_bdf2"},
                                           {"solver.max_iterations", iterations}}));
    while (!simulation.finished()) simulation.step();
    CHECK(simulation.state().time == 0.6);
    return std::make_pair(simulation.state().positions, simulation.counters().retried_steps);
  };
  const auto [whole, none] = end("0.05", "50");
  const auto [pieces, retried] = end("0.05", "2");
  const auto [fine, still_none] = end("0.00078125", "50");
  CHECK(none == 0);
  CHECK(still_none == 0);
  CHECK(retried > 0);
  CHECK((pieces - fine).lpNorm<Eigen::Infinity>() <= (whole - fine).lpNorm<Eigen::Infinity>());
}

TEST_CASE("Newton's method converges quadratically near the solution") {
  // Residuals of successive iterations of one static solve, read off by limiting the iterations.
  const Scenario scenario = Scenario::parse(
      kPressed, "scene",
      {{"time", ""}, {"analysis", "static"}, {"loads.0.point_force.force", "[0, 0.02]"}});
  Simulation simulation(scenario);
  const EquilibriumReport report = simulation.equilibrium();
  CHECK(!report.failed);
  CHECK(report.relaxations == 0);
  CHECK(report.newton_iterations <= 8);
  CHECK(report.residual <= 1e-9 * report.force_scale);
}

}  // namespace der::test
