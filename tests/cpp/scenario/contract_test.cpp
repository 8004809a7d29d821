// The scenes of the contract, key by key, and the defaults.

#include <doctest/doctest.h>

#include <string>
#include <variant>

#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"
#include "scene_texts.hpp"

namespace der {
namespace {

using scenario::Component;
using scenario::Location;
using test::beam;
using test::contains;
using test::diagnostics;

const std::string kTubeScene = R"(title: Simply supported aluminium tube, 2 kN at 0.75 m
rods:
  - name: beam
    nodes: 51
    from: [0, 0]
    to: [1, 0]
    cross_section: {tube: {inner_radius: 0.011, outer_radius: 0.013}}
    material: {youngs_modulus: 70e9, density: 2700}
supports:
  - {rod: beam, at: start, fix: [x, y]}
  - {rod: beam, at: end, fix: [y]}
loads:
  - point_force: {rod: beam, at: 0.75, force: [0, -2000]}
time: {duration: 1.0, step: 0.01, integrator: implicit_euler}
output:
  every: 0.01
  probes:
    deflection: {rod: beam, quantity: y, over: rod, reduce: min}
    roller: {rod: beam, at: end, quantity: x}
)";

const std::string kSpheresScene =
    R"(title: Three spheres on an elastic rod, falling through a viscous fluid
rods:
  - name: rod
    nodes: 3
    from: [0, 0]
    to: [0.1, 0]
    cross_section: {circle: {radius: 0.001}}
    material: {youngs_modulus: 1e9, density: 0}
    curvature: tangent
    spheres:
      - {at: all, radius: 0.005, density: 7000}
      - {at: middle, radius: 0.025, density: 7000}
loads:
  - gravity: [0, -9.8]
  - fluid: {density: 1000, viscosity: 1000}
time: {duration: 10, step: 0.01, integrator: implicit_euler}
output:
  probes:
    v_mid: {rod: rod, at: middle, quantity: vy}
    y_mid: {rod: rod, at: middle, quantity: y}
    angle: {rod: rod, at: middle, quantity: turning_angle}
)";

const std::string kArmScene = R"(rods:
  - name: arm
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1e6, EI: 1.5, GJ: 1.2, mass_per_length: 0.2}}
supports:
  - {rod: arm, at: start, clamp: true}
loads:
  - point_force: {rod: arm, at: end, force: [0, -1.5]}
  - moment: {rod: arm, at: end, moment: 0.2}
analysis: static
)";

TEST_CASE("contract: the tube") {
  const scenario::Scene scene = Scenario::parse(kTubeScene).scene();
  CHECK(scene.title == "Simply supported aluminium tube, 2 kN at 0.75 m");
  CHECK(scene.dimension == 2);
  CHECK(scene.model == scenario::ModelChoice::Auto);
  CHECK(scene.is_dynamic());
  REQUIRE(scene.rods.size() == 1);
  const scenario::Rod& rod = scene.rods[0];
  CHECK(rod.name == "beam");
  CHECK(rod.mark.line == 3);
  REQUIRE(rod.points.size() == 51);
  CHECK(rod.points[0] == scenario::Components{0.0, 0.0});
  CHECK(rod.points[25][0] == doctest::Approx(0.5).epsilon(1e-15));
  CHECK(rod.points[50] == scenario::Components{1.0, 0.0});
  CHECK(std::get<scenario::Tube>(rod.cross_section).inner_radius == 0.011);
  CHECK(std::get<scenario::Tube>(rod.cross_section).outer_radius == 0.013);
  REQUIRE(rod.material.has_value());
  CHECK(rod.material->youngs_modulus == 70e9);
  CHECK(rod.material->density == 2700.0);
  CHECK(rod.curvature == scenario::CurvatureMeasure::Angle);
  CHECK(std::holds_alternative<scenario::StressFreeReference>(rod.natural_curvature));
  CHECK(rod.initial_velocity.empty());

  REQUIRE(scene.supports.size() == 2);
  CHECK(scene.supports[0].at.kind == Location::Kind::Start);
  CHECK(scene.supports[0].fix == std::vector<Component>{Component::X, Component::Y});
  CHECK_FALSE(scene.supports[0].clamps());
  CHECK(scene.supports[1].at.kind == Location::Kind::End);
  CHECK(scene.supports[1].fix == std::vector<Component>{Component::Y});

  REQUIRE(scene.loads.size() == 1);
  CHECK(scene.loads[0].mark.line == 13);
  const auto& force = std::get<scenario::PointForce>(scene.loads[0].what);
  CHECK(force.at.kind == Location::Kind::ArcLength);
  CHECK(force.at.arc_length == 0.75);
  REQUIRE(force.force.constant());
  CHECK(force.force.values[0] == scenario::Components{0.0, -2000.0});

  CHECK(scene.time.duration == 1.0);
  CHECK(scene.time.step == 0.01);
  CHECK(scene.time.integrator == "implicit_euler");
  CHECK(scene.time.minimum_step == 0.01 / 1024);
  CHECK(scene.output.every == 0.01);
  REQUIRE(scene.output.probes.size() == 2);
  CHECK(scene.output.probes[0].name == "deflection");
  CHECK(scene.output.probes[0].over == scenario::Reduce::Min);
  CHECK_FALSE(scene.output.probes[0].at.has_value());
  CHECK(scene.output.probes[1].name == "roller");
  CHECK(scene.output.probes[1].over == scenario::Reduce::None);
  CHECK(scene.output.probes[1].at->kind == Location::Kind::End);
}

TEST_CASE("contract: the falling spheres") {
  const scenario::Scene scene = Scenario::parse(kSpheresScene).scene();
  const scenario::Rod& rod = scene.rods[0];
  CHECK(rod.curvature == scenario::CurvatureMeasure::Tangent);
  REQUIRE(rod.spheres.size() == 2);
  CHECK(rod.spheres[0].at.kind == Location::Kind::All);
  CHECK(rod.spheres[1].at.kind == Location::Kind::Middle);
  CHECK(rod.spheres[1].radius == 0.025);
  CHECK(std::get<scenario::Gravity>(scene.loads[0].what).acceleration.values.front()[1] == -9.8);
  CHECK(std::get<scenario::Fluid>(scene.loads[1].what).viscosity == 1000.0);
  CHECK(scene.output.every == 0.01);  // a thousandth of 10 s
  CHECK(scene.output.probes[2].quantity == "turning_angle");
}

TEST_CASE("contract: the arm in equilibrium") {
  const scenario::Scene scene = Scenario::parse(kArmScene).scene();
  CHECK(std::get<scenario::StaticAnalysis>(scene.analysis).leave_saddles);
  const auto& section = std::get<scenario::Stiffness>(scene.rods[0].cross_section);
  CHECK(section.EA == 1e6);
  CHECK(section.EI == 1.5);
  CHECK(section.GJ == 1.2);
  CHECK(section.mass_per_length == 0.2);
  CHECK_FALSE(scene.rods[0].material.has_value());
  CHECK(scene.supports[0].clamps());
  CHECK(std::get<scenario::Moment>(scene.loads[1].what).moment.values[0] == 0.2);
}

TEST_CASE("places: nodes by number, from either end") {
  const scenario::Scene scene =
      beam({{"supports",
             "[{rod: beam, at: {node: 3}, fix: [x]}, {rod: beam, at: {node: -1}, "
             "fix: [y]}, {rod: beam, at: 0.5, clamp: true}]"}})
          .scene();
  CHECK(scene.supports[0].at.kind == Location::Kind::Node);
  CHECK(scene.supports[0].at.node == 3);
  CHECK(scene.supports[1].at.node == -1);
  CHECK(scene.supports[2].at.arc_length == 0.5);
}

TEST_CASE("places: an arc length within rounding of the end is the end") {
  const scenario::Scene scene =
      beam({{"loads", "[{point_force: {rod: beam, at: 1.0000000001, force: [0, 1]}}]"}}).scene();
  CHECK(std::get<scenario::PointForce>(scene.loads[0].what).at.arc_length == 1.0);
  CHECK(contains(diagnostics({{"loads",
                               "[{point_force: {rod: beam, at: 1.00000001, force: [0, "
                               "1]}}]"}}),
                 "lies beyond the rod's length"));
}

TEST_CASE("places: a point force may act between nodes, or on all of them, a support may not") {
  CHECK(diagnostics({{"loads",
                      "[{point_force: {rod: beam, at: 0.123, force: [0, 1]}}, "
                      "{point_force: {rod: beam, at: all, force: [0, 1]}}, "
                      "{moment: {rod: beam, at: 0.777, moment: 1}}]"}})
            .empty());
  CHECK(contains(diagnostics({{"supports", "[{rod: beam, at: 0.123, fix: [x]}]"}}),
                 "the nearest is {node: 1} at 0.1 m"));
}

TEST_CASE("rods: a polyline's rest length is its length as drawn") {
  const std::vector<Override> polyline{{"rods.beam.nodes", ""},
                                       {"rods.beam.from", ""},
                                       {"rods.beam.to", ""},
                                       {"rods.beam.points", "[[0, 0], [3, 0], [3, 4]]"}};
  CHECK(beam(polyline).scene().rods[0].points.size() == 3);
  auto with_support = polyline;
  with_support.push_back({"supports", "[{rod: beam, at: 3, fix: [x]}]"});
  CHECK(diagnostics(with_support).empty());
  with_support.back().second = "[{rod: beam, at: middle, fix: [x]}]";
  CHECK(contains(diagnostics(with_support), "the nearest is {node: 1} at 3 m"));
}

TEST_CASE("rods: natural curvature and initial velocity, for all nodes or for each") {
  const scenario::Rod one = beam({{"rods.beam.nodes", "3"},
                                  {"rods.beam.natural_curvature", "2.5"},
                                  {"rods.beam.initial_velocity", "[1, -1]"}})
                                .scene()
                                .rods[0];
  CHECK(std::get<double>(one.natural_curvature) == 2.5);
  CHECK(one.initial_velocity ==
        std::vector<scenario::Components>{{1.0, -1.0}, {1.0, -1.0}, {1.0, -1.0}});
  const scenario::Rod each = beam({{"rods.beam.nodes", "3"},
                                   {"rods.beam.natural_curvature", "[0, 1, 2]"},
                                   {"rods.beam.initial_velocity", "[[0, 1], [0, 2], [0, 3]]"}})
                                 .scene()
                                 .rods[0];
  CHECK(std::get<std::vector<double>>(each.natural_curvature) == std::vector<double>{0, 1, 2});
  CHECK(each.initial_velocity[2] == scenario::Components{0.0, 3.0});
  CHECK(contains(diagnostics({{"rods.beam.nodes", "2"}, {"rods.beam.natural_curvature", "1"}}),
                 "cannot bend"));
  CHECK(diagnostics({{"rods.beam.nodes", "2"},
                     {"rods.beam.natural_curvature", "1"},
                     {"supports", "[{rod: beam, at: start, clamp: true}]"}})
            .empty());
}

TEST_CASE("supports: prescribed motion") {
  const scenario::Support support =
      beam({{"supports",
             "[{rod: beam, at: start, clamp: true, prescribe: {y: {times: [0, 1], "
             "values: [0, 0.2]}, angle: {times: [0, 2, 3], values: [0, 1, 0]}}}]"}})
          .scene()
          .supports[0];
  REQUIRE(support.prescribe.size() == 1);
  CHECK(support.prescribe[0].component == Component::Y);
  CHECK(support.prescribe[0].displacement.values == std::vector<double>{0.0, 0.2});
  REQUIRE(support.rotation.has_value());
  CHECK(support.rotation->times == std::vector<double>{0.0, 2.0, 3.0});
}

TEST_CASE("loads: every kind") {
  const scenario::Scene scene =
      beam({{"loads",
             "[{damping: {coefficient: 0.5}}, {damping: {coefficient: 1, rod: beam}}, "
             "{distributed_force: {rod: beam, force: [0, -3]}}, {distributed_force: {rod: "
             "beam, force: {times: [0, 1], values: [[0, 0], [1, 1]]}, from: 0.2, to: "
             "0.45}}]"}})
          .scene();
  CHECK_FALSE(std::get<scenario::Damping>(scene.loads[0].what).rod.has_value());
  CHECK(std::get<scenario::Damping>(scene.loads[1].what).rod == "beam");
  const auto& whole = std::get<scenario::DistributedForce>(scene.loads[2].what);
  CHECK(whole.from == 0.0);
  CHECK(whole.to == doctest::Approx(1.0).epsilon(1e-15));
  const auto& part = std::get<scenario::DistributedForce>(scene.loads[3].what);
  CHECK(part.from == 0.2);
  CHECK(part.to == 0.45);
  CHECK(part.force.values[1] == scenario::Components{1.0, 1.0});
}

TEST_CASE("masses: spheres and supports make up for a rod without density") {
  const std::vector<Override> massless{{"rods.beam.nodes", "3"},
                                       {"rods.beam.material.density", "0"}};
  const auto with = [&](std::vector<Override> more) {
    more.insert(more.begin(), massless.begin(), massless.end());
    return diagnostics(more);
  };
  CHECK(contains(with({}), "nodes 0, 1, 2 have none"));
  CHECK(with({{"rods.beam.spheres", "[{at: all, radius: 0.1, density: 1}]"}}).empty());
  CHECK(contains(with({{"rods.beam.spheres",
                        "[{at: all, radius: 0.1, density: 1}, {at: middle, "
                        "radius: 0.1, density: 0}]"}}),
                 "node 1 has none"));
  CHECK(with({{"rods.beam.spheres", "[{at: middle, radius: 0.1, density: 1}]"},
              {"supports",
               "[{rod: beam, at: start, clamp: true}, {rod: beam, at: end, fix: [x], "
               "prescribe: {y: 0}}]"}})
            .empty());
  CHECK(contains(with({{"rods.beam.spheres", "[{at: middle, radius: 0.1, density: 1}]"},
                       {"supports",
                        "[{rod: beam, at: start, clamp: true}, {rod: beam, at: end, "
                        "fix: [x]}]"}}),
                 "node 2 has none"));
  CHECK(with({{"time", ""}, {"analysis", "static"}}).empty());
}

TEST_CASE("probes: turning angles stand where the rod bends, curvature and moment anywhere") {
  const std::string at_start = "{a: {rod: beam, at: start, quantity: turning_angle}}";
  CHECK(contains(diagnostics({{"output.probes", at_start}}), "an end that is clamped"));
  CHECK(diagnostics(
            {{"output.probes", at_start}, {"supports", "[{rod: beam, at: start, clamp: true}]"}})
            .empty());
  CHECK(diagnostics({{"output.probes",
                      "{a: {rod: beam, at: start, quantity: moment}, b: {rod: beam, at: 0.123, "
                      "quantity: curvature, side: before}}"}})
            .empty());
  CHECK(diagnostics({{"output.probes",
                      "{a: {rod: beam, at: 0.123, quantity: tension}, b: {rod: "
                      "beam, at: 0.321, quantity: speed}, c: {quantity: "
                      "total_energy}, d: {rod: beam, quantity: bend_energy}}"}})
            .empty());
}

TEST_CASE("output: the time between frames is a whole number of steps") {
  const auto every = [](const std::string& duration, const std::string& step) {
    return beam({{"time.duration", duration}, {"time.step", step}}).scene().output.every;
  };
  CHECK(every("10", "0.01") == doctest::Approx(0.01).epsilon(1e-14));
  CHECK(every("1", "0.01") == doctest::Approx(0.01).epsilon(1e-14));
  CHECK(every("10", "1e-5") == doctest::Approx(0.01).epsilon(1e-14));
  CHECK(every("10", "0.003") == doctest::Approx(0.009).epsilon(1e-14));
  CHECK(diagnostics({{"time.step", "1e-5"}, {"output.every", "0.1"}}).empty());
  CHECK(contains(diagnostics({{"output.every", "0.025"}}), "write 0.02 or 0.03"));
}

TEST_CASE("solver: settings and their defaults") {
  const scenario::Solver defaults = beam().scene().solver;
  CHECK(defaults.linear == "auto");
  CHECK(defaults.max_iterations == 50);
  const scenario::Solver chosen =
      beam({{"solver",
             "{linear: banded, residual_tolerance: 1e-6, step_tolerance: 1e-7, "
             "max_iterations: 9}"}})
          .scene()
          .solver;
  CHECK(chosen.linear == "banded");
  CHECK(chosen.residual_tolerance == 1e-6);
  CHECK(chosen.step_tolerance == 1e-7);
  CHECK(chosen.max_iterations == 9);
}

TEST_CASE("one mistake causes one diagnostic") {
  // The rod cannot be laid out: nothing that refers to it is blamed, but its own keys still are.
  const std::string said = diagnostics({{"rods.beam.nodes", "many"},
                                        {"rods.beam.material", ""},
                                        {"supports", "[{rod: beam, at: 0.33, fix: [x]}]"},
                                        {"loads", "[{moment: {rod: beam, at: 7, moment: 1}}]"}});
  CHECK(contains(said, "expected a whole number, got 'many'"));
  CHECK(contains(said, "needs the key 'material'"));
  CHECK_FALSE(contains(said, "supports"));
  CHECK_FALSE(contains(said, "loads"));
}

}  // namespace
}  // namespace der
