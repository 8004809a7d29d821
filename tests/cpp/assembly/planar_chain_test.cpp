#include "der/assembly/planar_chain.hpp"

#include <doctest/doctest.h>

#include "assembly/chain_check.hpp"
#include "der/building/builder.hpp"
#include "der/scenario/reader.hpp"

namespace der::test {
namespace {

// Two rods with different stiffness and measure of curvature; ends of every kind; one node held in
// the middle; an edge and a half between clamps.
const char* const kRods = R"(
title: Rods
rods:
  - {name: arm, nodes: 12, from: [0, 0], to: [1, 0.2], natural_curvature: 1.5,
     cross_section: {stiffness: {EA: 900, EI: 0.7, mass_per_length: 0.3}}}
  - {name: bow, nodes: 7, from: [0, 1], to: [2, 1], curvature: tangent,
     cross_section: {stiffness: {EA: 50, EI: 2, mass_per_length: 0.1}}}
  - {name: stub, nodes: 4, from: [0, 2], to: [1, 2],
     cross_section: {stiffness: {EA: 50, EI: 2, mass_per_length: 0.1}}}
  - {name: ring, points: [[0, 4], [1, 4], [1.5, 5], [1.2, 6], [0.2, 6.2], [-0.4, 5]], closed: true,
     cross_section: {stiffness: {EA: 50, EI: 2, mass_per_length: 0.1}}}
supports:
  - {rod: arm, at: start, clamp: true}
  - {rod: bow, at: {node: 3}, fix: [y]}
  - {rod: stub, at: start, clamp: true}
  - {rod: stub, at: end, clamp: true}
actuation:
  - {name: bend, rod: arm, from: 0.21, to: 0.7, natural_curvature: 2}
  - {name: stretch, rod: arm, from: 0.1, profile: smooth, elongation: 0.1}
  - {name: bow, rod: bow, profile: linear, natural_curvature: -1}
  - {name: ring, rod: ring, from: 0.5, natural_curvature: 1}
time: {duration: 1, step: 0.1}
)";

}  // namespace

TEST_CASE("chains are found where edges follow one another") {
  const Model model = build_model(Scenario::parse(kRods).scene());
  const Pattern pattern = build_pattern(model);
  const auto chains = PlanarChain::find(model, MatrixLayout::compressed(pattern));
  // Edges next to a clamp start from its pivot and are no plain stretch elements; the one edge that
  // the clamps of the stub leave is no chain.
  REQUIRE(chains.size() == 3);
  CHECK(chains[0].range_of<Stretch<2>>().count == 10);
  CHECK(chains[0].range_of<PlanarBend<AngleCurvature>>().count == 9);
  CHECK(chains[0].range_of<PlanarBend<TangentCurvature>>().count == 0);
  // The ring but for its closing edge and the vertices at the ends of that.
  CHECK(chains[1].range_of<Stretch<2>>().count == 5);
  CHECK(chains[1].range_of<PlanarBend<AngleCurvature>>().count == 4);
  CHECK(chains[2].range_of<Stretch<2>>().count == 6);
  CHECK(chains[2].range_of<PlanarBend<TangentCurvature>>().count == 5);
}

TEST_CASE("a chain gives the gradient and the Hessian of its elements") {
  check_chains(build_model(Scenario::parse(kRods).scene()));
}

}  // namespace der::test
