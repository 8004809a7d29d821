// Loads and supports that a program sets by their names, in place of tables.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "der/core/error.hpp"
#include "der/simulation.hpp"

namespace der::test {
namespace {

// A soft rod in a fluid; everything that can have a name has one, and follows a table that is a
// straight line.
const char* const kRod = R"(
title: Rod
rods:
  - name: rod
    nodes: 7
    from: [0, 0]
    to: [1, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
    spheres: [{at: end, radius: 0.01, density: 3000}]
supports:
  - name: wall
    rod: rod
    at: start
    clamp: true
    prescribe:
      x: {times: [0, 1], values: [0, 0.2]}
      angle: {times: [0, 1], values: [0, -0.7]}
loads:
  - {name: water, fluid: {density: 500, viscosity: 0.1}}
  - {name: gravity, gravity: {times: [0, 1], values: [[0, -5], [10, 20]]}}
  - name: push
    point_force: {rod: rod, at: 0.55, force: {times: [0, 1], values: [[0, 0], [1, -2]]}}
  - name: line
    distributed_force: {rod: rod, from: 0.3, force: {times: [0, 1], values: [[0, 0], [2, 1]]}}
  - {name: bend, moment: {rod: rod, at: 0.4, moment: {times: [0, 1], values: [0, 0.3]}}}
  - name: follower
    point_force: {rod: rod, at: end, follower: true, force: {times: [0, 1], values: [[0, 0], [1, 1]]}}
time: {duration: 0.1, step: 0.001}
output: {every: 0.001}
)";

/// Its tables replaced by their values at time 0.
const std::vector<Override> kConstants{
    {"supports.wall.prescribe", "{x: 0, angle: 0}"},
    {"loads.gravity.gravity", "[0, -5]"},
    {"loads.push.point_force.force", "[0, 0]"},
    {"loads.line.distributed_force.force", "[0, 0]"},
    {"loads.bend.moment.moment", "0"},
    {"loads.follower.point_force.force", "[0, 0]"},
};

std::vector<Override> joined(std::vector<Override> changes, const std::vector<Override>& more) {
  changes.insert(changes.end(), more.begin(), more.end());
  return changes;
}

Scenario make_rod(const std::vector<Override>& changes, const std::vector<Override>& more = {}) {
  return Scenario::parse(kRod, "rod", joined(changes, more));
}

/// Sets everything to where the tables of the rod have it at time `t`.
void set_all(Simulation& rod, double t) {
  rod.set("wall", {0.2 * t, -0.7 * t});
  rod.set("gravity.x", {10.0 * t});
  rod.set("gravity.y", {-5.0 + 25.0 * t});
  rod.set("push", {t, -2.0 * t});
  rod.set("line", {2.0 * t, t});
  rod.set("bend", {0.3 * t});
  rod.set("follower", {t, t});
}

std::string message_of(const Simulation& rod, const std::string& name) {
  try {
    (void)rod.value(name);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("controls: values set from step to step do what tables would") {
  for (const StepperInfo& info : stepper_registry()) {
    CAPTURE(info.name);
    const std::string step = info.implicit ? "0.001" : "0.0001";
    const std::vector<Override> changes{{"time.integrator", std::string(info.name)},
                                        {"time.step", step},
                                        {"time.duration", "0.02"},
                                        {"output.every", step}};
    Simulation by_table(make_rod(changes));
    Simulation by_hand(make_rod(kConstants, changes));
    while (!by_hand.finished()) {
      set_all(by_hand, by_hand.state().time + by_hand.plan().step);
      by_hand.step();
      by_table.step();
    }
    const State& hand = by_hand.state();
    const State& table = by_table.state();
    CHECK((hand.positions - table.positions).lpNorm<Eigen::Infinity>() < 1e-10);
    CHECK((hand.velocities - table.velocities).lpNorm<Eigen::Infinity>() < 1e-8);
    CHECK(table.work.loads != 0.0);
    CHECK(std::abs(hand.work.loads - table.work.loads) < 1e-8 * std::abs(table.work.loads));
    CHECK(std::abs(hand.work.supports - table.work.supports) <
          1e-8 * std::abs(table.work.supports));
    CHECK(energies(by_hand.model(), hand)[EnergyTerm::Gravity] ==
          doctest::Approx(energies(by_table.model(), table)[EnergyTerm::Gravity]).epsilon(1e-9));
  }
}

TEST_CASE("controls: a value is reached evenly and kept") {
  Simulation rod(make_rod(kConstants));
  rod.set("push", {0.0, -1.0});
  rod.set("bend", {1.0}, 0.004);
  CHECK(rod.value("push.y").front() == 0.0);
  rod.step();
  CHECK(rod.value("push") == std::vector<double>{0.0, -1.0});
  CHECK(rod.value("bend.z").front() == doctest::Approx(0.25).epsilon(1e-12));
  for (int i = 0; i < 4; ++i) rod.step();
  CHECK(rod.value("bend") == std::vector<double>{1.0});
  CHECK(rod.value("wall") == std::vector<double>{0.0, 0.0});
}

TEST_CASE("controls: with adaptive steps a value is a table whose entries are hit") {
  const std::vector<Override> adaptive{{"time", "{duration: 0.1, tolerance: 1e-4}"},
                                       {"output.every", "0.01"}};
  const std::vector<Override> table{
      {"loads.push.point_force.force", "{times: [0, 0.03], values: [[0, 0], [0, -0.02]]}"}};
  Simulation by_table(make_rod(joined(kConstants, table), adaptive));
  Simulation by_hand(make_rod(kConstants, adaptive));
  by_hand.set("push", {0.0, -0.02}, 0.03);
  bool hit = false;
  while (!by_hand.finished()) {
    by_hand.step();
    by_table.step();
    CHECK(by_hand.state().time == by_table.state().time);
    hit = hit || by_hand.state().time == 0.03;
  }
  CHECK(hit);
  CHECK(by_hand.state().positions == by_table.state().positions);

  // Without a time, at the end of the next step.
  Simulation next(make_rod(kConstants, adaptive));
  for (int i = 0; i < 5; ++i) next.step();
  next.set("wall.angle", {0.01});
  const double proposed = next.state().time + next.state().next_step;
  while (next.state().time < proposed * (1.0 - 1e-12)) next.step();
  CHECK(next.state().time == doctest::Approx(proposed).epsilon(1e-12));
  CHECK(next.value("wall.angle").front() == 0.01);
}

TEST_CASE("controls: equilibria take values at once") {
  Simulation rod(make_rod(
      kConstants, {{"time", ""}, {"analysis", "static"}, {"output", ""}, {"loads.follower", ""}}));
  Simulation scene(make_rod(kConstants, {{"time", ""},
                                         {"analysis", "static"},
                                         {"output", ""},
                                         {"loads.follower", ""},
                                         {"loads.push.point_force.force", "[0.1, -0.05]"},
                                         {"loads.gravity.gravity", "[0, -1]"},
                                         {"supports.wall.prescribe.x", "0.1"}}));
  rod.set("push", {0.1, -0.05});
  rod.set("gravity", {0.0, -1.0});
  rod.set("wall.x", {0.1});
  rod.equilibrium();
  scene.equilibrium();
  CHECK((rod.state().positions - scene.state().positions).lpNorm<Eigen::Infinity>() < 1e-9);
}

TEST_CASE("controls: a saved state knows what was set") {
  Simulation rod(make_rod(kConstants));
  rod.step();
  set_all(rod, 0.5);
  const State saved = rod.state();
  rod.step();
  rod.step();
  const Vector once = rod.state().positions;
  set_all(rod, -0.5);
  rod.step();
  rod.restore(saved);
  rod.step();
  rod.step();
  CHECK(rod.state().positions == once);

  State wrong = saved;
  wrong.ramps.front().control = 1000;
  CHECK_THROWS_WITH_AS(rod.restore(wrong), doctest::Contains("neither prescribes nor names"),
                       Error);
}

TEST_CASE("controls: a name without a value says what to write") {
  const Simulation rod(make_rod(kConstants, {{"supports.wall.prescribe", ""}}));
  CHECK(message_of(rod, "psuh") ==
        "nothing that could be set has the name 'psuh'; did you mean 'push'?");
  CHECK(message_of(rod, "elsewhere").find("there is 'gravity', 'push', 'line'") !=
        std::string::npos);
  CHECK(message_of(rod, "water") ==
        "'water' cannot be set: a load of the kind 'fluid' has no value that a program sets");
  CHECK(message_of(rod, "wall.x").find("give it 'prescribe'") != std::string::npos);
  CHECK(message_of(rod, "push.z")
            .find("'push' has no component 'z'; it has 'x' and 'y'. This "
                  "model is planar") != std::string::npos);

  const Simulation unnamed(make_rod(kConstants, {{"loads.gravity", "{gravity: [0, -5]}"}}));
  CHECK(message_of(unnamed, "gravity").find("'- {name: gravity, gravity: ...}'") !=
        std::string::npos);
}

TEST_CASE("controls: a value that does not fit is refused and changes nothing") {
  Simulation rod(make_rod(kConstants));
  const auto nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(rod.set("push", {1.0}),
                       "'push' takes 2 values, for 'x' and 'y', but here is 1", Error);
  CHECK_THROWS_WITH_AS(rod.set("push", {1.0, nan}), "'push': y must be finite, got nan", Error);
  CHECK_THROWS_WITH_AS(rod.set("bend", {INFINITY}), doctest::Contains("must be finite"), Error);
  CHECK_THROWS_WITH_AS(rod.set("bend", {1.0}, 0.0), doctest::Contains("greater than 0 s"), Error);
  CHECK(rod.state().ramps.empty());
}

TEST_CASE("controls: what the load factor scales cannot be set") {
  const std::vector<Override> path{
      {"time", ""},
      {"output", ""},
      {"loads.follower", ""},
      {"loads.push.point_force.force", "[0, -1]"},
      {"analysis", "{continuation: {vary: loads.2, to: 1, step: 0.1}}"}};
  Simulation rod(make_rod(kConstants, path));
  CHECK_THROWS_WITH_AS(rod.set("push.y", {1.0}), doctest::Contains("follows the load factor"),
                       Error);
  rod.set("push.x", {0.0});
  rod.set("gravity", {0.0, -1.0});
}

TEST_CASE("controls: a load without a name costs no table") {
  const auto tables = [](const std::vector<Override>& changes) {
    const Simulation rod(make_rod(kConstants, changes));
    return rod.model().tables.size();
  };
  const auto named = tables({});
  const auto unnamed = tables({{"loads.gravity", "{gravity: [0, -5]}"}});
  CHECK(named - unnamed == 2);
}

TEST_CASE("controls: a support that holds several nodes moves them all") {
  Simulation rod(
      make_rod(kConstants, {{"supports.wall", "{name: wall, rod: rod, at: all, prescribe: {x: 0}}"},
                            {"loads.follower", ""}}));
  rod.set("wall", {0.3});
  rod.step();
  for (Index node = 0; node < rod.model().num_nodes; ++node) {
    const Index dof = rod.model().dof(node, 0);
    CHECK(rod.state().positions[dof] ==
          doctest::Approx(rod.model().initial_positions[dof] + 0.3).epsilon(1e-15));
  }
}

TEST_CASE("controls: in space") {
  const std::vector<Override> space{
      {"model", "spatial"},
      {"rods.rod.from", "[0, 0, 0]"},
      {"rods.rod.to", "[1, 0, 0]"},
      {"loads.gravity.gravity", "[0, -5, 0]"},
      {"loads.push.point_force.force", "[0, 0, 0]"},
      {"loads.line.distributed_force.force", "[0, 0, 0]"},
      {"loads.follower.point_force.force", "[0, 0, 0]"},
      {"rods.rod.material.poissons_ratio", "0.3"},
      {"supports.wall.prescribe", "{z: 0, twist: 0, rotation: {axis: [0, 1, 0], angle: 0}}"},
      {"loads.bend", "{name: bend, moment: {rod: rod, at: 0.4, moment: [0, 0, 0]}}"},
  };
  Simulation rod(make_rod(kConstants, space));
  rod.set("wall", {0.01, 0.02, 0.03});
  rod.set("bend", {0.0, 0.1, 0.2});
  rod.set("push.z", {0.5});
  rod.set("follower", {0.0, 0.0, 0.1});
  rod.set("gravity", {0.0, 0.0, -1.0});
  rod.step();
  CHECK(rod.value("wall") == std::vector<double>{0.01, 0.02, 0.03});
  CHECK(rod.value("bend") == std::vector<double>{0.0, 0.1, 0.2});
  CHECK(rod.state().positions[2] == 0.01);
}

}  // namespace der::test
