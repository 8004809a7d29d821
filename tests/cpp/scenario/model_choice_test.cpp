// `model: auto` chooses the smallest model by stated rules (model_choice.hpp): each rule on both
// sides.

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "der/scenario/model_choice.hpp"
#include "scene_texts.hpp"

namespace der {
namespace {

using scenario::ChosenModel;
using scenario::ModelChoice;
using test::contains;

using Overrides = std::vector<Override>;

const char* word(ModelChoice kind) {
  if (kind == ModelChoice::Auto) return "auto";
  if (kind == ModelChoice::Planar) return "planar";
  return kind == ModelChoice::Spatial ? "spatial" : "spatial_bend";
}

Overrides operator+(Overrides left, const Overrides& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

/// The beam along x with vectors of three components.
const Overrides kInSpace{{"rods.beam.from", "[0, 0, 0]"},
                         {"rods.beam.to", "[1, 0, 0]"},
                         {"rods.beam.material.poissons_ratio", "0.3"}};
/// A force out of the x-y plane.
const Overrides kAlongZ{{"loads", "[{point_force: {rod: beam, at: end, force: [0, 0, 1]}}]"}};
const Overrides kStrip{{"rods.beam.cross_section", "{rectangle: {width: 0.02, height: 0.001}}"}};

ChosenModel model_of(const Overrides& overrides) {
  return choose_model(test::beam(kInSpace + overrides).scene());
}

std::string chosen(const Overrides& overrides) { return word(model_of(overrides).kind); }

std::string points(const std::string& last) { return "[[0, 0, 0], [1, 0, 0], " + last + "]"; }

Overrides polyline(const std::string& points) {
  return {{"rods.beam.nodes", ""},
          {"rods.beam.from", ""},
          {"rods.beam.to", ""},
          {"rods.beam.points", points}};
}

TEST_CASE("model: scenes of two components are planar, unless a rod twists by itself") {
  CHECK(choose_model(test::beam().scene()).kind == ModelChoice::Planar);
  CHECK(choose_model(test::beam().scene()).reason ==
        "every position, force and support lies in the x-y plane");
  const ChosenModel twisted = choose_model(
      test::beam({{"rods.beam.natural_twist", "1"}, {"rods.beam.material.poissons_ratio", "0"}})
          .scene());
  CHECK(twisted.kind == ModelChoice::Spatial);
  CHECK(twisted.reason == "rod 'beam' has a natural twist");
}

TEST_CASE("model: positions and velocities in the plane, and out of it") {
  CHECK(chosen({}) == "planar");
  CHECK(chosen(polyline(points("[2, 1, 0]"))) == "planar");
  const ChosenModel seeded = model_of(polyline(points("[2, 1, 1e-6]")));
  CHECK(seeded.kind == ModelChoice::Spatial);
  CHECK(seeded.reason ==
        "node 2 of rod 'beam' lies at z = 1e-06 m, and rod 'beam' is curved without stress");
  CHECK(chosen({{"rods.beam.initial_velocity", "[0, 1, 0]"}}) == "planar");
  CHECK(chosen({{"rods.beam.initial_velocity", "[0, 0, 1]"}}) == "spatial_bend");
}

TEST_CASE("model: loads in the plane, and out of it") {
  CHECK(chosen({{"loads", "[{gravity: [0, -9.81, 0]}]"}}) == "planar");
  CHECK(model_of({{"loads", "[{gravity: [0, 0, -9.81]}]"}}).reason ==
        "loads.0.gravity has a z component, and no rod can twist");
  CHECK(chosen({{"loads", "[{distributed_force: {rod: beam, force: [1, 2, 0]}}]"}}) == "planar");
  const std::string table =
      "[{distributed_force: {rod: beam, force: {times: [0, 1], values: [[0, 0, 0], [0, 0, 1]]}}}]";
  CHECK(chosen({{"loads", table}}) == "spatial_bend");
  CHECK(chosen({{"loads", "[{moment: {rod: beam, at: end, moment: [0, 0, 2]}}]"}}) == "planar");
  const ChosenModel turned =
      model_of({{"loads", "[{moment: {rod: beam, at: end, moment: [0, 1, 0]}}]"}});
  CHECK(turned.kind == ModelChoice::Spatial);
  CHECK(turned.reason ==
        "loads.0.moment is about an axis that is not z, and loads.0.moment can twist rod 'beam'");
}

TEST_CASE("model: loads that turn with the rod in the plane, and out of it") {
  const auto loads = [](const std::string& kind, const std::string& amount) {
    return chosen(
        {{"loads", "[{" + kind + ": {rod: beam, at: end, follower: true, " + amount + "}}]"}});
  };
  CHECK(loads("point_force", "force: [0, 1, 0]") == "planar");
  CHECK(loads("moment", "moment: 1") == "planar");
  CHECK(loads("point_force", "force: [0, 0, 1]") == "spatial");
  CHECK(loads("moment", "moment: [1, 0, 0]") == "spatial");
}

TEST_CASE("model: springs against turning in the plane, and out of it") {
  const auto spring = [](const std::string& stiffness, const Overrides& more = {}) {
    return chosen(more + Overrides{{"supports",
                                    "[{rod: beam, at: start, fix: [x, y, z], spring: "
                                    "{rotational_stiffness: " +
                                        stiffness + "}}]"}});
  };
  CHECK(spring("2") == "planar");
  CHECK(spring("[1, 2, 3]") == "planar");
  const Overrides askew{{"rods.beam.cross_section.director", "[0, 1, 1]"}};
  CHECK(spring("[2, 2, 3]", askew) == "planar");
  CHECK(spring("[1, 2, 3]", askew) == "spatial");
  CHECK(spring("2", kAlongZ) == "spatial");
}

TEST_CASE("model: springs that pull in the plane, and out of it") {
  const auto spring = [](const std::string& keys) {
    return model_of({{"supports",
                      "[{rod: beam, at: start, clamp: true}, {rod: beam, at: end, "
                      "spring: {" +
                          keys + "}}]"}});
  };
  CHECK(spring("stiffness: 2, anchor: [1, 1, 0]").kind == ModelChoice::Planar);
  CHECK(spring("stiffness: [2, 2, 0], anchor: [1, 0, 1]").kind == ModelChoice::Planar);
  const ChosenModel pulled = spring("stiffness: [2, 2, 1e-6], anchor: [1, 0, 1e-6]");
  CHECK(pulled.kind == ModelChoice::SpatialBend);
  CHECK(pulled.reason == "the spring of supports.1 pulls along z, and no rod can twist");
}

TEST_CASE("model: supports that move in the plane, and out of it") {
  const auto support = [](const std::string& keys) {
    return chosen({{"supports", "[{rod: beam, at: start, " + keys + "}]"}});
  };
  CHECK(support("fix: [x, y, z]") == "planar");
  CHECK(support("prescribe: {z: {times: [0, 1], values: [0, 0]}}") == "planar");
  CHECK(support("prescribe: {z: {times: [0, 1], values: [0, 1]}}") == "spatial_bend");
  const auto turned = [&](const std::string& clamp, const std::string& axis) {
    return support("clamp: " + clamp + ", prescribe: {rotation: {axis: " + axis +
                   ", angle: {times: [0, 1], values: [0, 1]}}}");
  };
  CHECK(turned("true", "[0, 0, -2]") == "planar");
  CHECK(turned("true", "[0, 1, 0]") == "spatial_bend");
  CHECK(turned("true", "[0, 1, 1]") == "spatial_bend");
  CHECK(turned("true", "[1e-6, 1, 1]") == "spatial");  // it spins the section
  CHECK(turned("tangent", "[1e-6, 1, 1]") == "spatial_bend");
  // A rotation that stays as it is spins a section only if it has a name, so that a program may
  // change it.
  const std::string still = "clamp: true, prescribe: {rotation: {axis: [1, 1, 0], angle: 0}}";
  CHECK(support(still) == "spatial_bend");
  CHECK(support("name: hand, " + still) == "spatial");
  CHECK(support("clamp: true, prescribe: {twist: 0}") == "planar");
  CHECK(support("clamp: true, prescribe: {twist: {times: [0, 1], values: [0, 1]}}") == "spatial");
}

TEST_CASE("model: sections whose directors lie in the plane, and such that do not") {
  const auto strip = [](const std::string& director) {
    return chosen(kStrip + Overrides{{"rods.beam.cross_section.director", director}});
  };
  CHECK(chosen(kStrip) == "planar");
  CHECK(strip("[0, 0, 1]") == "planar");
  CHECK(strip("[0, -3, 0]") == "planar");
  CHECK(strip("[0.5, 0, 1]") == "planar");  // made perpendicular to the rod
  CHECK(strip("[0, 1e-6, 1]") == "spatial");
  CHECK(chosen({{"rods.beam.cross_section.director", "[0, 1, 1]"}}) == "planar");  // a circle
}

TEST_CASE("model: natural curvature about z, and about other axes") {
  const auto curved = [](const std::string& curvature) {
    return chosen({{"rods.beam.natural_curvature", curvature}});
  };
  CHECK(curved("2") == "planar");
  CHECK(curved("[0, 2]") == "planar");
  CHECK(curved("[1e-6, 2]") == "spatial");
  CHECK(chosen({{"rods.beam.natural_curvature", "[2, 0]"},
                {"rods.beam.cross_section.director", "[0, 1, 0]"}}) == "planar");
}

TEST_CASE("model: a twist of the rod itself") {
  CHECK(chosen({{"rods.beam.natural_twist", "0"}}) == "planar");
  CHECK(chosen({{"rods.beam.natural_twist", "1e-6"}}) == "spatial");
  CHECK(chosen({{"rods.beam.natural_twist", "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]"}}) == "planar");
  CHECK(chosen({{"rods.beam.natural_twist", "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1e-6]"}}) == "spatial");
  CHECK(chosen({{"rods.beam.initial_twist", "1e-6"}}) == "spatial");
}

TEST_CASE("model: bending without twist takes equal bending stiffnesses") {
  CHECK(chosen(kAlongZ) == "spatial_bend");
  const auto section = [](const std::string& text) {
    return chosen(kAlongZ + Overrides{{"rods.beam.cross_section", text}});
  };
  CHECK(section("{rectangle: {width: 0.02, height: 0.02}}") == "spatial_bend");
  CHECK(section("{rectangle: {width: 0.02, height: 0.021}}") == "spatial");
  CHECK(section("{ellipse: {width: 0.02, height: 0.02}}") == "spatial_bend");
  CHECK(section("{ellipse: {width: 0.02, height: 0.021}}") == "spatial");
  const auto direct = [](const std::string& keys) {
    return chosen(kAlongZ +
                  Overrides{{"rods.beam.material", ""},
                            {"rods.beam.cross_section",
                             "{stiffness: {EA: 1, GJ: 1, mass_per_length: 1, " + keys + "}}"}});
  };
  CHECK(direct("EI: 1") == "spatial_bend");
  CHECK(direct("EI1: 2, EI2: 2") == "spatial_bend");
  CHECK(direct("EI1: 1, EI2: 2") == "spatial");
  CHECK(direct("EI: 1, rotary_inertia: 0") == "spatial_bend");
  CHECK(direct("EI: 1, rotary_inertia: 1e-6") == "spatial");
}

TEST_CASE("model: a rotary inertia counts where something moves") {
  const Overrides spins =
      kAlongZ + Overrides{{"rods.beam.material", ""},
                          {"rods.beam.cross_section",
                           "{stiffness: {EA: 1, EI: 1, GJ: 1, mass_per_length: 1, "
                           "rotary_inertia: 1}}"},
                          {"supports", "[{rod: beam, at: start, clamp: true}]"}};
  CHECK(chosen(spins) == "spatial");  // over time
  CHECK(chosen(spins + Overrides{{"time", ""}, {"analysis", "modes"}}) == "spatial");
  CHECK(chosen(spins + Overrides{{"time", ""}, {"analysis", "static"}}) == "spatial_bend");
}

TEST_CASE("model: bending without twist takes rods that are straight without stress") {
  CHECK(chosen(kAlongZ + Overrides{{"rods.beam.from", "[0.1, 0.2, 0.3]"},
                                   {"rods.beam.to", "[0.7, 0.9, 1.3]"}}) == "spatial_bend");
  const Overrides bent = polyline(points("[2, 0, 1e-6]"));
  CHECK(chosen(bent) == "spatial");
  CHECK(chosen(bent + Overrides{{"rods.beam.natural_curvature", "0"}}) == "spatial_bend");
  CHECK(chosen(bent + Overrides{{"rods.beam.natural_curvature", "[0, 0]"}}) == "spatial_bend");
  CHECK(chosen(bent + Overrides{{"rods.beam.natural_curvature", "[0, 1e-6]"}}) == "spatial");
  CHECK(chosen(bent + Overrides{{"rods.beam.natural_curvature", "[[0, 0], [0, 0], [0, 0]]"}}) ==
        "spatial_bend");
  const std::string cable = "{stiffness: {EA: 1, EI: 0, GJ: 1, mass_per_length: 1}}";
  CHECK(chosen(bent + Overrides{{"rods.beam.material", ""}, {"rods.beam.cross_section", cable}}) ==
        "spatial_bend");
}

TEST_CASE("model: a ring that leaves its plane is twisted by its writhe") {
  const auto ring = [](const std::string& last, const std::string& closed) {
    return polyline(points(last)) +
           Overrides{{"rods.beam.closed", closed}, {"rods.beam.natural_curvature", "[0, 0]"}};
  };
  CHECK(chosen(ring("[1, 1, 0]", "true")) == "planar");
  CHECK(chosen(ring("[1, 1, 1]", "false")) == "spatial_bend");
  const ChosenModel tilted = model_of(ring("[1, 1, 1]", "true"));
  CHECK(tilted.kind == ModelChoice::Spatial);
  CHECK(contains(tilted.reason, "rod 'beam' is closed, so that its writhe twists it"));
  const Overrides cable{
      {"rods.beam.material", ""},
      {"rods.beam.cross_section", "{stiffness: {EA: 1, EI: 0, GJ: 1, mass_per_length: 1}}"}};
  CHECK(chosen(ring("[1, 1, 1]", "true") + cable) == "spatial_bend");
  CHECK(chosen(ring("[1, 1, 0]", "true") + Overrides{{"model", "spatial_bend"}}) == "spatial_bend");
}

TEST_CASE("model: bending without twist takes at most one section of a rod that is held") {
  const auto held = [](const std::string& start, const std::string& end) {
    return model_of(kAlongZ +
                    Overrides{{"supports", "[{rod: beam, at: start, clamp: " + start +
                                               "}, {rod: beam, at: end, clamp: " + end + "}]"},
                              {"loads.0.point_force.at", "middle"}});
  };
  CHECK(held("true", "tangent").kind == ModelChoice::SpatialBend);
  CHECK(held("tangent", "tangent").kind == ModelChoice::SpatialBend);
  CHECK(held("true", "true").reason ==
        "loads.0.point_force has a z component, and supports.0 and supports.1 both hold the "
        "section of rod 'beam'");
  CHECK(held("true", "true").kind == ModelChoice::Spatial);

  const auto held_all_along = [](const std::string& clamp) {
    return model_of({{"loads", "[{gravity: [0, 0, -1]}]"},
                     {"supports", "[{rod: beam, at: all, clamp: " + clamp + "}]"}});
  };
  CHECK(held_all_along("tangent").kind == ModelChoice::SpatialBend);
  CHECK(held_all_along("true").kind == ModelChoice::Spatial);
  CHECK(held_all_along("true").reason ==
        "loads.0.gravity has a z component, and supports.0 holds every section of rod 'beam'");
}

TEST_CASE("model: actuations that bend the rod in the plane, and out of it") {
  // The width points along z, so that the second director lies in the plane.
  const auto bent = [](const std::string& curvature, const Overrides& more = {}) {
    return model_of(more + Overrides{{"actuation", "[{name: bend, rod: beam, natural_curvature: " +
                                                       curvature + "}]"}});
  };
  const std::string table = "{times: [0, 1], values: [0, 2]}";
  CHECK(bent("2").kind == ModelChoice::Planar);
  CHECK(bent("[0, 2]").kind == ModelChoice::Planar);
  CHECK(bent("[0, " + table + "]").kind == ModelChoice::Planar);
  CHECK(bent("[2, 0]").kind == ModelChoice::Spatial);
  CHECK(bent("[1e-6, 2]").kind == ModelChoice::Spatial);
  CHECK(bent("[" + table + ", 2]").kind == ModelChoice::Spatial);
  CHECK(bent("[2, 0]").reason ==
        "actuation.bend bends rod 'beam' to two sides, and actuation.bend curves rod 'beam' "
        "without stress");
  // A program may drive either of two that are 0.
  CHECK(bent("[0, 0]").kind == ModelChoice::Spatial);

  const Overrides upright{{"rods.beam.cross_section.director", "[0, 1, 0]"}};
  CHECK(bent("[2, 0]", upright).kind == ModelChoice::Planar);
  CHECK(bent("[0, 2]", upright).kind == ModelChoice::Spatial);
  const Overrides askew{{"rods.beam.cross_section.director", "[0, 1, 1]"}};
  CHECK(bent("[0, 2]", askew).kind == ModelChoice::Spatial);
}

TEST_CASE("model: bending without twist takes rods that no actuation bends or twists") {
  const auto driven = [](const std::string& what) {
    return model_of(kAlongZ +
                    Overrides{{"actuation", "[{name: muscle, rod: beam, " + what + "}]"}});
  };
  CHECK(driven("elongation: 0.1").kind == ModelChoice::SpatialBend);
  CHECK(driven("natural_curvature: [0, 1]").kind == ModelChoice::Spatial);
  CHECK(driven("natural_curvature: [0, 1]").reason ==
        "loads.0.point_force has a z component, and actuation.muscle curves rod 'beam' without "
        "stress");
  CHECK(driven("natural_twist: 1").kind == ModelChoice::Spatial);
  CHECK(driven("natural_twist: 1").reason ==
        "loads.0.point_force has a z component, and actuation.muscle twists rod 'beam'");
}

TEST_CASE("model: actuations that twist the rod are not of a plane") {
  const auto driven = [](const std::string& what) {
    return model_of({{"actuation", "[{name: muscle, rod: beam, " + what + "}]"}});
  };
  CHECK(driven("elongation: 0.1").kind == ModelChoice::Planar);
  CHECK(driven("natural_twist: 0").kind == ModelChoice::Spatial);  // a program may drive it
  CHECK(driven("natural_twist: 1").reason == "actuation.muscle twists rod 'beam'");
}

TEST_CASE("model: one that is asked for may be larger than needed, not smaller") {
  for (const char* model : {"planar", "spatial_bend", "spatial"}) {
    const ChosenModel asked = model_of({{"model", model}});
    CHECK(std::string(word(asked.kind)) == model);
    CHECK(asked.reason == "asked for by the scene");
  }
  const auto refused = [](const Overrides& overrides) {
    return test::diagnostics(kInSpace + overrides);
  };
  CHECK(contains(refused(kAlongZ + Overrides{{"model", "planar"}}),
                 "model: 'planar' cannot represent this scene: loads.0.point_force has a z"));
  CHECK(contains(refused(kStrip + Overrides{{"model", "spatial_bend"}}),
                 "model: 'spatial_bend' cannot represent this scene: the two bending"));
  const auto driven = [](const std::string& what) {
    return Overrides{{"actuation", "[{name: muscle, rod: beam, " + what + "}]"}};
  };
  CHECK(
      contains(refused(driven("natural_twist: 1") + Overrides{{"model", "planar"}}),
               "model: 'planar' cannot represent this scene: actuation.muscle twists rod 'beam'"));
  CHECK(contains(
      refused(driven("natural_twist: 1") + Overrides{{"model", "spatial_bend"}}),
      "model: 'spatial_bend' cannot represent this scene: actuation.muscle twists rod 'beam'"));
  CHECK(contains(
      refused(driven("natural_curvature: [0, 1]") + Overrides{{"model", "spatial_bend"}}),
      "model: 'spatial_bend' cannot represent this scene: actuation.muscle curves rod 'beam'"));
}

TEST_CASE("model: the same is chosen of a scene in the terms of its model") {
  // The reader has brought the scene to its model already; a second choice gives the same.
  for (const Overrides& overrides : {Overrides{}, kAlongZ, kStrip + kAlongZ,
                                     Overrides{{"rods.beam.natural_curvature", "[0, 2]"}},
                                     Overrides{{"rods.beam.natural_curvature", "[2, 0]"}}}) {
    const scenario::Scene scene = test::beam(kInSpace + overrides).scene();
    CHECK(scene.dimension == (choose_model(scene).kind == ModelChoice::Planar ? 2 : 3));
    CHECK(scene.rods[0].points[0].size() == static_cast<std::size_t>(scene.dimension));
  }
}

}  // namespace
}  // namespace der
