// Scenes in space: what is read, and in which terms a scene stands once its model is known.

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"
#include "scene_texts.hpp"

namespace der {
namespace {

using scenario::Clamp;
using scenario::Component;
using scenario::Components;
using scenario::CurvaturePair;
using scenario::Scene;
using test::contains;

const std::string kHelix = R"(title: A pre-twisted strip, held by a wall and turned at its end
model: auto
rods:
  - name: strip
    points: [[0, 0, 0], [1, 0, 0], [2, 1, 1]]
    cross_section: {ellipse: {width: 0.02, height: 0.001}, director: [0, 1, 1]}
    material: {youngs_modulus: 1e9, poissons_ratio: 0.5, density: 1000}
    natural_curvature: [[0, 0.1], [0.2, 0.3], [0.4, 0.5]]
    natural_twist: 0.6
    initial_twist: -2
    initial_velocity: [1, 2, 3]
  - name: bar
    nodes: 5
    from: [0, 0, 1]
    to: [0, 4, 1]
    cross_section: {stiffness: {EA: 1, EI1: 2, EI2: 3, GJ: 4, mass_per_length: 5, rotary_inertia: 6}}
    natural_curvature: 0.5
supports:
  - {rod: strip, at: start, clamp: true, prescribe: {twist: {times: [0, 1], values: [0, 7]}}}
  - rod: strip
    at: end
    clamp: tangent
    prescribe: {z: {times: [0, 1], values: [0, 8]}, rotation: {axis: [0, 2, 0], angle: 0}}
  - {rod: bar, at: end, fix: [z, x]}
loads:
  - gravity: [0, 0, -9.81]
  - point_force: {rod: bar, at: 2.5, force: {times: [0, 1], values: [[0, 0, 0], [1, 2, 3]]}}
time: {duration: 1, step: 0.01}
)";

/// A direction across x, at this angle from y toward z.
std::string across_x(double angle) {
  return "[0, " + std::to_string(std::cos(angle)) + ", " + std::to_string(std::sin(angle)) + "]";
}

double signed_curvature(const Scene& scene) {
  return std::get<double>(scene.rods[0].natural_curvature);
}

TEST_CASE("space: every key") {
  const Scene scene = Scenario::parse(kHelix).scene();
  CHECK(scene.dimension == 3);
  const scenario::Rod& strip = scene.rods[0];
  CHECK(strip.points[2] == Components{2, 1, 1});
  CHECK(std::get<scenario::Ellipse>(strip.cross_section).width == 0.02);
  CHECK(strip.director == Components{0, 1, 1});
  CHECK(strip.material->poissons_ratio == 0.5);
  CHECK_FALSE(strip.material->shear_modulus.has_value());
  CHECK(std::get<std::vector<CurvaturePair>>(strip.natural_curvature)[2].first == 0.4);
  CHECK(std::get<std::vector<CurvaturePair>>(strip.natural_curvature)[2].second == 0.5);
  CHECK(std::get<double>(strip.natural_twist) == 0.6);
  CHECK(strip.initial_twist == -2.0);
  CHECK(strip.initial_velocity[2] == Components{1, 2, 3});
  const scenario::Rod& bar = scene.rods[1];
  CHECK(bar.points[1] == Components{0, 1, 1});
  CHECK_FALSE(bar.director.has_value());
  CHECK(std::holds_alternative<scenario::StressFreeReference>(bar.natural_twist));
  const auto& stiffness = std::get<scenario::Stiffness>(bar.cross_section);
  CHECK_FALSE(stiffness.EI.has_value());
  CHECK(stiffness.EI1 == 2.0);
  CHECK(stiffness.EI2 == 3.0);
  CHECK(stiffness.rotary_inertia == 6.0);
  REQUIRE(scene.supports.size() == 3);
  CHECK(scene.supports[0].clamp == Clamp::Section);
  CHECK(scene.supports[0].twist->values == std::vector<double>{0, 7});
  CHECK(scene.supports[1].clamp == Clamp::Tangent);
  CHECK(scene.supports[1].prescribe[0].component == Component::Z);
  CHECK(scene.supports[1].axis_rotation->axis == Components{0, 2, 0});
  CHECK_FALSE(scene.supports[1].rotation.has_value());
  CHECK(scene.supports[2].clamp == Clamp::None);
  CHECK(scene.supports[2].fix == std::vector<Component>{Component::Z, Component::X});
  CHECK(std::get<scenario::Gravity>(scene.loads[0].what).acceleration.values.front() ==
        Components{0, 0, -9.81});
  const auto& force = std::get<scenario::PointForce>(scene.loads[1].what);
  CHECK(force.force.values[1] == Components{1, 2, 3});
  CHECK_FALSE(force.follower);
  CHECK(scene.warnings.empty());
}

TEST_CASE("space: a number is a curvature about z, wherever the width points") {
  // z x t of the bar along y is -x; its width points along z, so its height t x z along x.
  const Scene scene = Scenario::parse(kHelix).scene();
  const auto bar = std::get<CurvaturePair>(scene.rods[1].natural_curvature);
  CHECK(bar.first == doctest::Approx(0.0));
  CHECK(bar.second == doctest::Approx(-0.5));
  // Along x, z x t is y.
  for (const double angle : {0.3, 1.2, 2.5, -0.7}) {
    const Scene spatial = test::beam({{"model", "spatial"},
                                      {"rods.beam.natural_curvature", "2"},
                                      {"rods.beam.material.poissons_ratio", "0"},
                                      {"rods.beam.from", "[0, 0, 0]"},
                                      {"rods.beam.to", "[1, 0, 0]"},
                                      {"rods.beam.cross_section.director", across_x(angle)}})
                              .scene();
    // m1 = (0, cos, sin), m2 = x x m1 = (0, -sin, cos)
    const auto pair = std::get<CurvaturePair>(spatial.rods[0].natural_curvature);
    CHECK(pair.first * std::cos(angle) - pair.second * std::sin(angle) ==
          doctest::Approx(2.0).epsilon(2e-6));  // the digits of `across_x`
    CHECK(std::abs(pair.first * std::sin(angle) + pair.second * std::cos(angle)) < 4e-6);
  }
}

/// The diagnostics of a beam in space, of a given model, with a probe of a quantity at its end.
std::string diagnostics_of_probe(const std::string& quantity, const std::string& model) {
  return test::diagnostics(
      {{"model", model},
       {"rods.beam.from", "[0, 0, 0]"},
       {"rods.beam.to", "[1, 0, 0]"},
       {"rods.beam.material.poissons_ratio", "0.3"},
       {"output", "{probes: {tip: {rod: beam, at: end, quantity: " + quantity + "}}}"}});
}

TEST_CASE("space: a model that 'auto' chose for a scene in space has the quantities of space") {
  for (const std::string quantity : {"z", "twist", "curvature", "curvature_1"}) {
    CHECK(diagnostics_of_probe(quantity, "auto").empty());
  }
  CHECK(contains(diagnostics_of_probe("slope", "auto"),
                 "output.probes.tip.quantity: a scene of three components has no 'slope', flat as "
                 "it is: an angle from an axis tells no direction in space, take 'tx', 'ty' and "
                 "'tz'; or write 'model: planar'"));
}

TEST_CASE("space: a probe asks for what the chosen model has, and chooses none") {
  CHECK(diagnostics_of_probe("slope", "planar").empty());
  CHECK(contains(diagnostics_of_probe("z", "planar"),
                 "output.probes.tip.quantity: the model 'planar' has no 'z': write 'model: "
                 "spatial', or 'spatial_bend' for a rod that cannot twist"));
  CHECK(contains(diagnostics_of_probe("twist", "planar"), "the model 'planar' has no 'twist'"));
  CHECK(diagnostics_of_probe("z", "spatial_bend").empty());
  CHECK(contains(diagnostics_of_probe("curvature_1", "spatial_bend"),
                 "the model 'spatial_bend' has no 'curvature_1': write 'model: spatial', in which "
                 "sections count"));
  CHECK(contains(diagnostics_of_probe("slope", "spatial_bend"), "take 'tx', 'ty' and 'tz'"));
  CHECK(diagnostics_of_probe("curvature_1", "spatial").empty());
  CHECK(contains(diagnostics_of_probe("natural_curvature", "spatial"),
                 "the model 'spatial' has no 'natural_curvature': in space take"));
}

TEST_CASE("space: a scene of three components in the plane is a planar scene") {
  const Scene scene =
      test::beam({{"rods.beam.from", "[0, 0, 0]"},
                  {"rods.beam.to", "[1, 0, 0]"},
                  {"rods.beam.natural_curvature", "[0, 2]"},
                  {"rods.beam.initial_velocity", "[1, 2, 0]"},
                  {"supports",
                   "[{rod: beam, at: start, clamp: true, prescribe: {x: {times: [0, 1], "
                   "values: [0, 1]}, z: 0, twist: 0, rotation: {axis: [0, 0, -3], angle: {times: "
                   "[0, 1], values: [0, 2]}}}}, {rod: beam, at: end, fix: [z, y]}, {rod: beam, "
                   "at: middle, spring: {stiffness: 5, anchor: [1, 2, 0]}}]"},
                  {"loads",
                   "[{gravity: [1, 2, 0]}, {moment: {rod: beam, at: end, moment: [0, 0, 3]}}, "
                   "{foundation: {rod: beam, stiffness: [1, 2, 3]}}, {moment: {rod: beam, at: "
                   "end, moment: {times: [0, 1], values: [[0, 0, 1], [0, 0, 2]]}}}]"}})
          .scene();
  CHECK(scene.dimension == 2);
  CHECK(scene.rods[0].points[10] == Components{1, 0});
  CHECK(scene.rods[0].initial_velocity[0] == Components{1, 2});
  CHECK(signed_curvature(scene) == -2.0);  // the height points along -y
  CHECK(scene.supports[0].prescribe.size() == 1);
  CHECK_FALSE(scene.supports[0].twist.has_value());
  CHECK_FALSE(scene.supports[0].axis_rotation.has_value());
  CHECK(scene.supports[0].rotation->values == std::vector<double>{0, -2});
  CHECK(scene.supports[1].fix == std::vector<Component>{Component::Y});
  CHECK(scene.supports[2].spring->stiffness == Components{5, 5});
  CHECK(scene.supports[2].spring->anchor == Components{1, 2});
  CHECK(std::get<scenario::Gravity>(scene.loads[0].what).acceleration.values.front() ==
        Components{1, 2});
  const auto& constant = std::get<scenario::Moment>(scene.loads[1].what);
  CHECK(constant.moment.values == std::vector<double>{3});
  CHECK(constant.moment_vector.values.empty());
  CHECK(std::get<scenario::Foundation>(scene.loads[2].what).stiffness == Components{1, 2});
  const auto& table = std::get<scenario::Moment>(scene.loads[3].what);
  CHECK(table.moment.times == std::vector<double>{0, 1});
  CHECK(table.moment.values == std::vector<double>{1, 2});
}

TEST_CASE("space: a scene of two components runs in space where it asks for that") {
  const Scene scene =
      test::beam({{"model", "spatial"},
                  {"rods.beam.natural_curvature", "[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]"},
                  {"rods.beam.material.shear_modulus", "1"},
                  {"rods.beam.cross_section.director", "[0, 1]"},
                  {"supports",
                   "[{rod: beam, at: start, clamp: true, prescribe: {angle: {times: [0, 1], "
                   "values: [0, 2]}}}]"},
                  {"loads", "[{distributed_force: {rod: beam, force: [0, 1]}}]"}})
          .scene();
  CHECK(scene.dimension == 3);
  CHECK(scene.rods[0].points[10] == Components{1, 0, 0});
  CHECK(scene.rods[0].director == Components{0, 1, 0});
  const auto& pairs = std::get<std::vector<CurvaturePair>>(scene.rods[0].natural_curvature);
  CHECK(pairs[7].first == 7.0);  // the width points along y
  CHECK(pairs[7].second == 0.0);
  CHECK_FALSE(scene.supports[0].rotation.has_value());
  CHECK(scene.supports[0].axis_rotation->axis == Components{0, 0, 1});
  CHECK(scene.supports[0].axis_rotation->angle.values == std::vector<double>{0, 2});
  CHECK(std::get<scenario::DistributedForce>(scene.loads[0].what).force.values[0] ==
        Components{0, 1, 0});
}

TEST_CASE("space: two numbers are one for each node, or a pair where vectors have three") {
  const std::vector<Override> flat{{"rods.beam.nodes", "2"},
                                   {"rods.beam.natural_curvature", "[1, 2]"},
                                   {"supports", "[{rod: beam, at: start, clamp: true}]"}};
  CHECK(std::get<std::vector<double>>(test::beam(flat).scene().rods[0].natural_curvature) ==
        std::vector<double>{1, 2});
  std::vector<Override> space = flat;
  space.insert(space.end(), {{"rods.beam.from", "[0, 0, 0]"},
                             {"rods.beam.to", "[1, 0, 0]"},
                             {"rods.beam.material.poissons_ratio", "0.3"}});
  const auto pair = std::get<CurvaturePair>(test::beam(space).scene().rods[0].natural_curvature);
  CHECK(pair.first == 1.0);
  CHECK(pair.second == 2.0);
}

TEST_CASE("space: lengths, corners and touching rods") {
  const std::vector<Override> diagonal{{"rods.beam.from", "[0, 0, 0]"},
                                       {"rods.beam.to", "[2, 3, 6]"}};
  const auto with = [&](std::vector<Override> more) {
    more.insert(more.begin(), diagonal.begin(), diagonal.end());
    return more;
  };
  CHECK(test::diagnostics(with({{"supports", "[{rod: beam, at: 3.5, fix: [z]}]"}})).empty());
  CHECK(contains(test::diagnostics(with({{"supports", "[{rod: beam, at: 7.1, fix: [z]}]"}})),
                 "lies beyond the rod's length, 7 m"));
  const std::vector<Override> polyline{{"rods.beam.nodes", ""},
                                       {"rods.beam.from", ""},
                                       {"rods.beam.to", ""},
                                       {"rods.beam.material.poissons_ratio", "0.3"}};
  const auto drawn = [&](const std::string& points) {
    auto overrides = polyline;
    overrides.push_back({"rods.beam.points", points});
    return overrides;
  };
  CHECK(contains(test::diagnostics(drawn("[[0, 0, 0], [1, 1, 1], [0, 0, 0.000000001]]")),
                 "turns straight back"));
  CHECK(test::diagnostics(drawn("[[0, 0, 0], [1, 1, 1], [0, 0, 1]]")).empty());
  // The first and the last point differ in z alone.
  const std::string open = "[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 1]]";
  CHECK(test::beam(drawn(open)).scene().warnings.empty());
  const std::string closed = "[[0, 0, 1], [1, 0, 0], [1, 1, 0], [0, 0, 1]]";
  REQUIRE(test::beam(drawn(closed)).scene().warnings.size() == 1);
  CHECK(contains(test::beam(drawn(closed)).scene().warnings[0], "is its first, (0, 0, 1) m"));
}

TEST_CASE("space: a node in space that has no mass is held along z too") {
  const auto said = [](const std::string& fix) {
    return test::diagnostics({{"rods.beam.nodes", "2"},
                              {"rods.beam.from", "[0, 0, 0]"},
                              {"rods.beam.to", "[1, 0, 1]"},
                              {"rods.beam.material.density", "0"},
                              {"rods.beam.spheres", "[{at: start, radius: 0.1, density: 1}]"},
                              {"supports", "[{rod: beam, at: end, fix: [" + fix + "]}]"}});
  };
  CHECK(said("x, y, z").empty());
  CHECK(contains(said("x, y"), "node 1 has none"));
}

TEST_CASE("space: a support takes up a force along z") {
  const Scene scene =
      test::beam({{"rods.beam.from", "[0, 0, 0]"},
                  {"rods.beam.to", "[1, 0, 0]"},
                  {"supports", "[{rod: beam, at: end, fix: [z]}]"},
                  {"loads", "[{point_force: {rod: beam, at: end, force: [0, 0, 1]}}]"}})
          .scene();
  REQUIRE(scene.warnings.size() == 1);
  CHECK(contains(scene.warnings[0], "the z component of loads.0.point_force"));
}

}  // namespace
}  // namespace der
