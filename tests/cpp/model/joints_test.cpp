// Joints in a plane: numbering, the ends of legs, and rotations that have no inertia.
#include <doctest/doctest.h>

#include <Eigen/LU>

#include "der/assembly/pattern.hpp"
#include "der/building/builder.hpp"
#include "der/model/state.hpp"
#include "der/output/probe.hpp"
#include "der/scenario/reader.hpp"
#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"
#include "der/solvers/joint_rotations.hpp"

namespace der::test {
namespace {

/// A beam of two rods in a row with a joint between them, a moment there, and one end clamped.
Scenario beam_of_two(int nodes, const std::string& analysis = "analysis: static") {
  const std::string rest = "nodes: " + std::to_string(nodes) +
                           ", cross_section: {stiffness: {EA: 1e4, EI: 2, mass_per_length: 1}}}\n";
  return Scenario::parse("rods:\n  - {name: a, from: [0, 0], to: [0.37, 0], " + rest +
                         "  - {name: b, from: [0.37, 0], to: [1, 0], " + rest +
                         "joints: [{name: j, of: [{rod: a, at: end}, {rod: b, at: start}]}]\n"
                         "supports: [{rod: a, at: start, clamp: true}]\n"
                         "loads: [{moment: {joint: j, moment: 0.1}}]\n" +
                         analysis);
}

}  // namespace

TEST_CASE("rods share the node of a joint, and its rotation stands beside it") {
  const Model model = build_model(beam_of_two(6).scene());
  CHECK(model.num_nodes == 11);
  CHECK(model.rods[0].nodes.back() == model.rods[1].nodes.front());
  CHECK(model.dofs.num_rotations() == 2);  // that of the clamp is held
  CHECK(model.num_free() == 2 * 10 + 1);
  // Two nodes and a rotation on one side of a joint, two nodes on the other.
  CHECK(build_pattern(model).half_bandwidth == 8);  // an arc sees four nodes
}

TEST_CASE("a rod that is only clamped and free at its ends has a chain's band and one node more") {
  const auto text = [](const char* joints) {
    return Scenario::parse(
        std::string("rods:\n"
                    "  - {name: a, nodes: 9, from: [0, 0], to: [1, 0], cross_section: "
                    "{stiffness: {EA: 1, EI: 1, mass_per_length: 1}}}\n"
                    "  - {name: b, nodes: 2, from: [2, 0], to: [3, 0], cross_section: "
                    "{stiffness: {EA: 1, EI: 0, mass_per_length: 1}}}\n"
                    "  - {name: c, nodes: 2, from: [3, 0], to: [3, 1], cross_section: "
                    "{stiffness: {EA: 1, EI: 0, mass_per_length: 1}}}\n") +
        joints +
        "supports: [{rod: a, at: start, clamp: true}, {rod: b, at: start, fix: [x, y]}, "
        "{rod: c, at: end, fix: [x, y]}]\nanalysis: static");
  };
  const Model chain = build_model(text("").scene());
  const Model jointed = build_model(
      text("joints: [{name: j, kind: hinge, of: [{rod: b, at: end}, {rod: c, at: start}]}]\n")
          .scene());
  CHECK(jointed.num_free() == chain.num_free() - 2);
  CHECK(build_pattern(jointed).half_bandwidth == build_pattern(chain).half_bandwidth + 2);
}

TEST_CASE("the end of a leg is as stiff as a beam whose moment is linear") {
  // Under an end moment M a cantilever of length L has turned by M L/EI and moved by M L^2/(2 EI)
  // at its end, whatever its cells; summed from the compliances of its cells.
  for (const int cells : {1, 2, 3, 7}) {
    std::vector<double> lengths(static_cast<std::size_t>(cells), 1.0 / cells);
    const Leg leg{0, cells, {}, {}};
    double direction = 0.0;
    double place = 0.0;
    const auto turn = [&](int node) {
      const Mat3 C = end_compliance(leg, true, lengths);
      if (cells == 1) return C.row(node).sum();
      if (cells == 2) return C.row(node).sum();
      const bool in_end = node < 2 || node > cells - 2;
      return in_end ? C.row(node < 2 ? node : cells - node).sum() : 1.0 / cells;
    };
    for (int node = 0; node < cells; ++node) {
      direction += turn(node);
      place += direction / cells;
    }
    direction += turn(cells);
    CHECK(direction == doctest::Approx(1.0).epsilon(1e-14));
    CHECK(place == doctest::Approx(0.5).epsilon(1e-14));
  }
}

TEST_CASE("the compliance of the end of a leg is symmetric and positive, also of uneven cells") {
  for (const double second : {0.5, 1.0, 2.0}) {
    for (const Index cells : {1, 2, 3}) {
      const std::vector<double> lengths{1.0, second, second};
      const Mat3 C = end_compliance({0, cells, {}, {}}, true, lengths);
      const Index angles = cells == 2 ? 3 : 2;
      CHECK((C - C.transpose()).isZero(0.0));
      CHECK(C.topLeftCorner(angles, angles).determinant() > 0.01);
      CHECK(C.topLeftCorner(2, 2).determinant() > 0.01);
    }
  }
}

TEST_CASE("rotations follow from the places of the nodes") {
  Simulation simulation(beam_of_two(6));
  simulation.settle(true);
  const Model& model = simulation.model();
  const Vector found = simulation.state().positions;
  Vector coordinates = found;
  coordinates[model.dofs.rotation(1)] += 0.3;
  Vector controls;
  evaluate_controls(model, simulation.state(), 0.0, controls);
  JointRotations rotations(model);
  rotations.settle(controls, simulation.state().extra_force, coordinates);
  CHECK((coordinates - found).lpNorm<Eigen::Infinity>() < 1e-12);
  // A moment from outside turns the joint alone: the legs resist it by their end cells.
  Vector extra = simulation.state().extra_force;
  extra[model.dofs.rotation(1)] = 0.5;
  rotations.settle(controls, extra, coordinates);
  const double stiffness = 2.0 * 144.0 / 47.0 * (5.0 / 0.37 + 5.0 / 0.63);
  CHECK(coordinates[model.dofs.rotation(1)] - found[model.dofs.rotation(1)] ==
        doctest::Approx(0.5 / stiffness).epsilon(1e-5));  // the arcs of bent legs resist, too
}

TEST_CASE("what a joint tells is what its rods were loaded with") {
  // Only the moment acts: the rod before the joint bears it as it is, the rod behind it nothing.
  Simulation simulation(Scenario::parse(beam_of_two(6).to_yaml() +
                                        "output:\n  probes:\n"
                                        "    rotation: {joint: j, quantity: rotation}\n"
                                        "    moment_a: {joint: j, leg: a, quantity: moment_z}\n"
                                        "    moment_b: {joint: j, leg: b, quantity: moment_z}\n"
                                        "    force_x: {joint: j, leg: a, quantity: force_x}\n"
                                        "    force_y: {joint: j, leg: b, quantity: force_y}\n"
                                        "    slope: {rod: b, at: end, quantity: slope}\n"));
  simulation.settle(true);
  const double expected[] = {0.1 * 0.37 / 2.0, -0.1, 0.0, 0.0, 0.0, 0.1 * 0.37 / 2.0};
  const auto probes = make_probes(simulation.scenario().scene(), simulation.model());
  for (const Probe& probe : probes) {
    CAPTURE(probe.name());
    const auto number = static_cast<std::size_t>(&probe - probes.data());
    CHECK(probe.value(simulation.model(), simulation.state()) ==
          doctest::Approx(expected[number]).epsilon(1e-9));
  }
}

TEST_CASE("a sudden moment on a joint does not make its rotation ring") {
  // The implicit midpoint rule would carry the error of a rotation on for ever.
  Simulation simulation(
      beam_of_two(6, "time: {duration: 1, step: 0.01, integrator: implicit_midpoint}"));
  const Model& model = simulation.model();
  Vector controls;
  evaluate_controls(model, simulation.state(), 0.0, controls);
  JointRotations rotations(model);
  for (int step = 0; step < 20; ++step) {
    simulation.step();
    Vector settled = simulation.state().positions;
    rotations.settle(controls, simulation.state().extra_force, settled);
    CHECK((settled - simulation.state().positions).lpNorm<Eigen::Infinity>() < 1e-13);
  }
}

}  // namespace der::test
