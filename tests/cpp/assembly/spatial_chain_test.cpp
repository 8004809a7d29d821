#include "der/assembly/spatial_chain.hpp"

#include <doctest/doctest.h>

#include "assembly/chain_check.hpp"
#include "der/building/builder.hpp"
#include "der/scenario/reader.hpp"

namespace der::test {
namespace {

// Rods with different sections, rest shapes and measures of curvature; ends of every kind; one node
// held in the middle; a rod between clamps that leave no chain; a ring.
const char* const kRods = R"(
title: Rods
model: spatial
rods:
  - name: arm
    nodes: 9
    from: [0, 0, 0]
    to: [1, 0.2, 0.4]
    natural_curvature: [1.5, -0.7]
    natural_twist: 2
    cross_section: {stiffness: {EA: 900, EI1: 0.7, EI2: 0.2, GJ: 0.4, mass_per_length: 0.3},
                    director: [0, 0, 1]}
  - name: bow
    points: [[0, 1, 0], [0.3, 1.1, 0], [0.6, 1.1, 0.2], [0.8, 0.9, 0.3], [1.2, 0.8, 0.3]]
    curvature: tangent
    cross_section: {stiffness: {EA: 50, EI: 2, GJ: 1, mass_per_length: 0.1}}
  - {name: stub, nodes: 4, from: [0, 2, 0], to: [1, 2, 0],
     cross_section: {stiffness: {EA: 50, EI: 2, GJ: 1, mass_per_length: 0.1}}}
  - name: ring
    points: [[0, 4, 0], [1, 4, 0.1], [1.5, 5, 0], [1.2, 6, 0.3], [0.2, 6.2, 0], [-0.4, 5, 0]]
    closed: true
    initial_twist: 0.4
    natural_twist: 0.1
    cross_section: {stiffness: {EA: 50, EI1: 2, EI2: 0.5, GJ: 1, mass_per_length: 0.1}}
supports:
  - {rod: arm, at: start, clamp: true}
  - {rod: bow, at: {node: 3}, fix: [y]}
  - {rod: stub, at: start, clamp: true}
  - {rod: stub, at: end, clamp: true}
actuation:
  - {name: bend, rod: arm, from: 0.21, to: 0.7, natural_curvature: [2, -1]}
  - {name: stretch, rod: arm, from: 0.1, profile: smooth, elongation: 0.1}
  - {name: twist, rod: bow, profile: linear, natural_twist: -1}
  - {name: ring, rod: ring, from: 0.5, natural_curvature: [1, 0.3]}
time: {duration: 1, step: 0.1}
)";

const char* const kBendingRods = R"(
title: Rods
model: spatial_bend
rods:
  - {name: arm, nodes: 9, from: [0, 0, 0], to: [1, 0.2, 0.4],
     cross_section: {stiffness: {EA: 900, EI: 0.7, GJ: 1, mass_per_length: 0.3}}}
  - {name: bow, nodes: 5, from: [0, 1, 0], to: [1, 1, 2], curvature: tangent,
     cross_section: {stiffness: {EA: 50, EI: 2, GJ: 1, mass_per_length: 0.1}}}
supports:
  - {rod: arm, at: start, clamp: true}
  - {rod: bow, at: {node: 3}, fix: [y]}
actuation:
  - {name: stretch, rod: arm, from: 0.1, profile: smooth, elongation: 0.1}
time: {duration: 1, step: 0.1}
)";

std::vector<SpatialChain> chains_of(const Model& model) {
  const Pattern pattern = build_pattern(model);
  return SpatialChain::find(model, MatrixLayout::compressed(pattern));
}

}  // namespace

TEST_CASE("chains in space are found where edges follow one another") {
  const auto sections = chains_of(build_model(Scenario::parse(kRods).scene()));
  REQUIRE(sections.size() == 3);
  CHECK(sections[0].range_of<Stretch<3>>().count == 7);
  CHECK(sections[0].range_of<SpatialBend<AngleCurvature>>().count == 6);
  CHECK(sections[0].range_of<SpatialBend<TangentCurvature>>().count == 0);
  // The ring but for its closing edge and the vertices at the ends of that.
  CHECK(sections[1].range_of<Stretch<3>>().count == 5);
  CHECK(sections[1].range_of<SpatialBend<AngleCurvature>>().count == 4);
  CHECK(sections[2].range_of<SpatialBend<TangentCurvature>>().count == 3);
  const auto tangents = chains_of(build_model(Scenario::parse(kBendingRods).scene()));
  REQUIRE(tangents.size() == 2);
  CHECK(tangents[0].range_of<IsotropicBend<AngleCurvature>>().count == 6);
  CHECK(tangents[1].range_of<IsotropicBend<TangentCurvature>>().count == 3);
}

TEST_CASE("a chain in space gives the gradient and the Hessian of its elements") {
  check_chains(build_model(Scenario::parse(kRods).scene()));
  check_chains(build_model(Scenario::parse(kBendingRods).scene()));
}

}  // namespace der::test
