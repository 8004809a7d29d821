// The watch on energy that the time stepping creates: what it stops, what it marks, and what it
// must not take for the stepper's.
#include "der/steppers/energy_monitor.hpp"

#include <doctest/doctest.h>

#include <string>

#include "der/core/error.hpp"
#include "der/simulation.hpp"

namespace der::test {
namespace {

// The midpoint rule makes energy of the whipping end, which turns by a radian and more in a step.
const char* const kWhip = R"(
title: Whip
rods:
  - name: rod
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
supports:
  - {rod: rod, at: start, clamp: true}
loads:
  - gravity: [0, -9.81]
time: {duration: 20, step: 0.005, integrator: implicit_midpoint}
)";

Scenario whip(const std::vector<Override>& changes) {
  return Scenario::parse(kWhip, "whip", changes);
}

void run_to_end(Simulation& simulation) {
  while (!simulation.finished()) simulation.step();
}

}  // namespace

TEST_CASE("a motion that the stepper drives stops by name, with a state that can be read") {
  Simulation simulation(whip({}));
  std::string status;
  std::string message;
  try {
    run_to_end(simulation);
  } catch (const DivergedError& error) {
    status = error.status();
    message = error.what();
  }
  CHECK(status == "unstable_motion");
  CHECK(message.find("the integrator created") != std::string::npos);
  CHECK(message.find("energy_momentum") != std::string::npos);
  CHECK(message.find("allow_unstable: true") != std::string::npos);
  const State& state = simulation.state();
  CHECK(state.positions.allFinite());
  CHECK(state.audit.unreliable_from > 0.0);
  CHECK(state.audit.unreliable_from <= state.time);
  // Not long after it has got there: the whip has about 1 J to exchange.
  CHECK(state.audit.created > 0.5 * state.audit.exchanged);
  CHECK(state.audit.exchanged == doctest::Approx(1.0).epsilon(0.1));
  CHECK(state.audit.created < 1e3);

  Simulation allowed(whip({{"time.allow_unstable", "true"}, {"time.duration", "4"}}));
  run_to_end(allowed);
  CHECK(allowed.state().audit.unreliable_from == state.audit.unreliable_from);
}

TEST_CASE("steps that are short enough raise no doubt") {
  Simulation simulation(whip({{"time.step", "2e-4"}, {"time.duration", "1"}}));
  run_to_end(simulation);
  CHECK(simulation.state().audit.unreliable_from < 0.0);
  CHECK(simulation.state().audit.created < 1e-5 * simulation.state().audit.exchanged);
}

TEST_CASE("a state that goes back takes its audit along") {
  Simulation simulation(whip({{"time.allow_unstable", "true"}}));
  for (int i = 0; i < 64; ++i) simulation.step();
  const State saved = simulation.state();
  for (int i = 0; i < 320; ++i) simulation.step();
  const EnergyAudit first = simulation.state().audit;
  REQUIRE(first.unreliable_from > 0.0);
  simulation.restore(saved);
  CHECK(simulation.state().audit.unreliable_from < 0.0);
  for (int i = 0; i < 320; ++i) simulation.step();
  CHECK(simulation.state().audit.created == first.created);
  CHECK(simulation.state().audit.exchanged == first.exchanged);
  CHECK(simulation.state().audit.written == 0.0);
  CHECK(simulation.state().audit.unreliable_from == first.unreliable_from);
}

TEST_CASE("what a program writes between two steps is not the stepper's energy") {
  Simulation simulation(whip({{"time.step", "2e-4"}, {"time.duration", "1"}}));
  simulation.state().velocities.tail(10).setConstant(0.3);
  for (int i = 0; i < 400; ++i) {
    // A kick now and then, of many times what the weight has done by then.
    if (i % 37 == 5) simulation.state().velocities.tail(10).array() += 1.0;
    if (i == 200) simulation.state().positions[41] += 1e-4;
    simulation.step();
  }
  const EnergyAudit& audit = simulation.state().audit;
  CHECK(audit.written > 0.5);
  CHECK(audit.unreliable_from < 0.0);
  CHECK(audit.created < 1e-3 * audit.exchanged);
}

TEST_CASE("rounding is no energy: a rod at rest, and one that hardly moves") {
  for (const char* loads : {"9.81", "1e-9", "0"}) {
    Simulation simulation(
        whip({{"loads.0.gravity", "[0, -" + std::string(loads) + "]"}, {"time.duration", "0.5"}}));
    simulation.equilibrium();
    run_to_end(simulation);
    CHECK(simulation.state().audit.unreliable_from < 0.0);
  }
}

TEST_CASE("a run of few steps that ends where all stands still is not judged by that instant") {
  // Half a period of a rod that spins about a pin: it stands still at the end, as at the start.
  Simulation simulation(whip({{"supports.0.clamp", "false"},
                              {"supports.0.fix", "[x, y]"},
                              {"time.step", "0.04"},
                              {"time.duration", "0.96"}}));
  run_to_end(simulation);
  CHECK(simulation.state().audit.exchanged > 0.5);
  CHECK(simulation.state().audit.unreliable_from < 0.0);
}

}  // namespace der::test
