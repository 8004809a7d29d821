// Every motion that a scene can prescribe to a support: what the engine does with the tables of
// motions has to reach each of them.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "der/building/builder.hpp"
#include "der/scenario/reader.hpp"
#include "der/scenario/scenario.hpp"
#include "der/steppers/fine_tables.hpp"

namespace der::test {
namespace {

const std::vector<std::string> kMotions{"x", "y", "z", "twist", "rotation.angle"};

/// A clamp in space that moves by tables with an entry at 1 ms, or has been moved.
Scenario moved_clamp(bool tables) {
  const std::string motion = tables ? "{times: [0, 0.001, 1], values: [0, 0.1, 0.2]}" : "0.1";
  return Scenario::parse(R"(
title: A clamp moved in every way
model: spatial
rods:
  - name: rod
    nodes: 5
    from: [0, 0, 0]
    to: [1, 0, 0]
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, poissons_ratio: 0.3, density: 1000}
supports:
  - rod: rod
    at: start
    clamp: true
    prescribe: {x: )" + motion +
                         ", y: " + motion + ", z: " + motion + ", twist: " + motion +
                         ", rotation: {axis: [1, 2, 3], angle: " + motion + "}}\n" +
                         (tables ? "time: {duration: 1, step: 0.01}\n" : "analysis: static\n"));
}

}  // namespace

TEST_CASE("motions: the warning of fine tables looks at every table") {
  const std::vector<std::string> warnings = fine_table_warnings(moved_clamp(true).scene(), 0.01);
  CHECK(warnings.size() == kMotions.size());
  for (const std::string& motion : kMotions) {
    CAPTURE(motion);
    const std::string start = "the table supports.0.prescribe." + motion + " has entries at";
    CHECK(std::any_of(warnings.begin(), warnings.end(),
                      [&](const std::string& warning) { return warning.rfind(start, 0) == 0; }));
  }
}

TEST_CASE("motions: a load factor scales every one, from rest at the factor 0") {
  scenario::Scene scene = moved_clamp(false).scene();
  scenario::ContinuationAnalysis path;
  path.vary = scenario::Varied::Supports;
  scene.analysis = path;
  const Model model = build_model(scene);
  REQUIRE(model.load_variation.has_value());
  const LinearInFactor& controls = model.load_variation->controls;
  const auto motions = static_cast<Index>(kMotions.size());
  CHECK((controls.change.array() == 0.1).count() == motions);
  // Another control, HeldFrame::inset, belongs to the rotation and is zero but in stages.
  CHECK(controls.at(0.0).tail(motions + 1).isZero(0.0));
  CHECK((controls.at(2.0).tail(motions + 1).array() == 0.2).count() == motions);
}

}  // namespace der::test
