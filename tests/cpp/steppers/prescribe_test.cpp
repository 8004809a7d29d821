// Supports that a program moves from step to step, in place of their tables.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "der/core/error.hpp"
#include "der/simulation.hpp"

namespace der::test {
namespace {

// A soft rod whose clamp turns and whose foot moves aside, both at a constant rate.
const char* const kArm = R"(
title: Arm
rods:
  - name: arm
    nodes: 7
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
supports:
  - {rod: arm, at: end, prescribe: {y: 0}}
  - rod: arm
    at: start
    clamp: true
    prescribe:
      x: {times: [0, 1], values: [0, 0.2]}
      angle: {times: [0, 1], values: [0, -0.7]}
loads:
  - gravity: [0, -1]
time: {duration: 0.1, step: 0.001}
output: {every: 0.001}
)";

Scenario make_arm(const std::vector<Override>& changes = {}) {
  return Scenario::parse(kArm, "arm", changes);
}

}  // namespace

TEST_CASE("a support moved from step to step does what its table would") {
  for (const StepperInfo& info : stepper_registry()) {
    CAPTURE(info.name);
    const std::string step = info.implicit ? "0.001" : "0.0001";
    const std::vector<Override> changes{
        {"time.integrator", std::string(info.name)}, {"time.step", step}, {"output.every", step}};
    Simulation by_table(make_arm(changes));
    Simulation by_hand(make_arm(changes));
    while (!by_hand.finished()) {
      const double next = by_hand.state().time + by_hand.plan().step;
      by_hand.prescribe(1, "x", 0.2 * next);
      by_hand.prescribe(1, "angle", -0.7 * next);
      by_hand.step();
      by_table.step();
    }
    const State& hand = by_hand.state();
    const State& table = by_table.state();
    CHECK(hand.positions[0] == doctest::Approx(0.02).epsilon(1e-12));
    CHECK((hand.positions - table.positions).lpNorm<Eigen::Infinity>() < 1e-9);
    CHECK((hand.velocities - table.velocities).lpNorm<Eigen::Infinity>() < 1e-7);
    CHECK(std::abs(hand.work.supports - table.work.supports) <
          1e-8 * std::abs(table.work.supports));
  }
}

TEST_CASE("a value that was set is reached evenly and kept") {
  Simulation arm(make_arm());
  arm.step();
  CHECK(arm.prescribed(1, "angle") == doctest::Approx(-0.0007).epsilon(1e-15));
  arm.prescribe(1, "angle", 0.3);
  CHECK(arm.prescribed(1, "angle") == doctest::Approx(-0.0007).epsilon(1e-15));
  arm.step();
  CHECK(arm.prescribed(1, "angle") == 0.3);
  arm.step();
  CHECK(arm.prescribed(1, "angle") == 0.3);
  CHECK(arm.prescribed(1, "x") == doctest::Approx(0.0006).epsilon(1e-15));  // the table goes on
}

TEST_CASE("a saved state knows where its supports were going") {
  Simulation arm(make_arm());
  arm.step();
  arm.prescribe(1, "angle", 0.1);
  const State saved = arm.state();
  arm.step();
  const Vector once = arm.state().positions;
  arm.prescribe(1, "angle", -0.4);
  arm.step();
  arm.restore(saved);
  arm.step();
  CHECK(arm.state().positions == once);
}

TEST_CASE("equilibria take a support's new place at once") {
  Simulation arm(make_arm());
  arm.prescribe(0, "y", 0.25);
  arm.equilibrium();
  CHECK(arm.state().positions[13] == 0.25);
  arm.step();
  CHECK(arm.state().positions[13] == 0.25);
}

TEST_CASE("what a scene does not prescribe cannot be moved") {
  Simulation arm(make_arm());
  CHECK_THROWS_WITH_AS(arm.prescribe(0, "x", 0.1),
                       doctest::Contains("it prescribes y of support 0, x of support 1"), Error);
  CHECK_THROWS_WITH_AS(arm.prescribe(7, "x", 0.1),
                       "there is no support 7: the scene has 2, counted from 0", Error);
  CHECK_THROWS_WITH_AS(arm.prescribed_components(2),
                       "there is no support 2: the scene has 2, counted from 0", Error);
  CHECK_THROWS_WITH_AS(
      arm.prescribe(0, "turn", 0.1),
      "a support has no component 'turn' to move: there are 'x', 'y', 'z', 'angle' "
      "and 'twist'",
      Error);
  CHECK_THROWS_WITH_AS(arm.prescribe(0, "y", std::nan("")),
                       doctest::Contains("y must be finite, got nan"), Error);
}

}  // namespace der::test
