// The energy-momentum method keeps the energy in motion that no step resolves, with every kind of
// element: what the ledger calls numerical is rounding, and what the solver leaves is little.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "der/simulation.hpp"

namespace der::test {
namespace {

const char* const kWhip = R"(
title: Whip
rods:
  - name: rod
    nodes: 11
    from: [0, 0]
    to: [1, 0]
    curvature: MEASURE
    cross_section: {circle: {radius: 0.01}}
    material: {youngs_modulus: 1e7, density: 1000}
supports:
  - {rod: rod, at: start, clamp: true}
loads:
  - gravity: [0, -9.81]
time: {duration: 10, step: 0.005, integrator: energy_momentum}
)";

const char* const kEverything = R"(
title: Everything that stores or does work
rods:
  - name: rod
    nodes: 13
    from: [0, 0]
    to: [1, 0]
    curvature: MEASURE
    natural_curvature: 0.5
    cross_section: {stiffness: {EA: 200, EI: 0.05, mass_per_length: 0.3}}
    spheres:
      - {at: middle, radius: 0.02, density: 2000}
supports:
  - rod: rod
    at: start
    clamp: true
    prescribe: {angle: {times: [0, 0.3, 0.7, 1], values: [0, 1.5, -1, 0.3]},
                x: {times: [0, 0.5, 1], values: [0, 0.2, 0.1]}}
  - {rod: rod, at: 0.43, spring: {stiffness: [3, 1]}}
  - {rod: rod, at: 0.7, spring: {rotational_stiffness: 0.05}}
  - {rod: rod, at: end, spring: {rotational_stiffness: 0.02}}
loads:
  - gravity: [0, -9.81]
  - moment: {rod: rod, at: end, moment: {times: [0, 0.4, 1], values: [0, 0.1, -0.1]}}
  - point_force: {rod: rod, at: 0.6, force: {times: [0, 1], values: [[0, 0], [0.5, 1]]}}
  - damping: {coefficient: 0.05}
  - fluid: {density: 0, viscosity: 0.5}
time: {duration: 1, step: 0.004, integrator: energy_momentum}
)";

Simulation make(std::string text, const std::string& measure) {
  text.replace(text.find("MEASURE"), 7, measure);
  return Simulation(Scenario::parse(
      text, "scene", {{"solver.residual_tolerance", "1e-12"}, {"solver.step_tolerance", "1e-13"}}));
}

double loss(const Simulation& simulation) {
  return numerical_loss(simulation.state().work, energies(simulation.model(), simulation.state()));
}

}  // namespace

TEST_CASE("the energy-momentum method keeps the energy of motion that its steps do not resolve") {
  for (const char* measure : {"angle", "tangent"}) {
    CAPTURE(measure);
    Simulation simulation = make(kWhip, measure);
    double largest_loss = 0.0;
    double largest_turn = 0.0;  // of the last edge in a step
    double before = 0.0;
    while (!simulation.finished()) {
      simulation.step();
      largest_loss = std::max(largest_loss, std::abs(loss(simulation)));
      const Vec2 edge =
          simulation.state().positions.tail<2>() - simulation.state().positions.segment<2>(18);
      const double direction = std::atan2(edge.y(), edge.x());
      largest_turn =
          std::max(largest_turn, std::abs(std::remainder(direction - before, 2.0 * 3.14159265)));
      before = direction;
    }
    CHECK(largest_turn > 0.3);
    CHECK(largest_loss < 1e-11);  // of 1.5 J
    CHECK(std::abs(simulation.state().work.solver) < 1e-9);
  }
}

TEST_CASE("the ledger of the energy-momentum method closes with every element, load and support") {
  for (const char* measure : {"angle", "tangent"}) {
    CAPTURE(measure);
    Simulation simulation = make(kEverything, measure);
    double largest = 0.0;
    while (!simulation.finished()) {
      simulation.step();
      largest = std::max(largest, std::abs(loss(simulation)));
    }
    const Work& work = simulation.state().work;
    CHECK(std::abs(work.loads) > 1e-3);
    CHECK(std::abs(work.supports) > 5e-3);
    CHECK(work.drag > 1e-3);
    CHECK(largest < 1e-12);
    CHECK(std::abs(work.solver) < 1e-10);
  }
}

}  // namespace der::test
