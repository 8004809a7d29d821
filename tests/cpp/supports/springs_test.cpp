#include <doctest/doctest.h>

#include <string>

#include "der/assembly/pattern.hpp"
#include "der/building/builder.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/point_spring.hpp"
#include "der/energies/rotational_spring.hpp"
#include "der/scenario/reader.hpp"
#include "der/simulation.hpp"
#include "der/statics/rigid_motion.hpp"
#include "der/steppers/stable_step.hpp"

namespace der::test {
namespace {

/// A straight rod of 11 nodes with these supports, and nothing else.
std::string scene_with(const std::string& supports) {
  return R"(
rods:
  - name: rod
    nodes: 11
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1e3, EI: 1, mass_per_length: 1}}
analysis: static
supports:
)" + supports;
}

Model model_with(const std::string& supports) {
  return build_model(Scenario::parse(scene_with(supports)).scene());
}

template <class Kernel>
std::size_t count(const Model& model) {
  return elements_of<Kernel>(*model.elements).size();
}

}  // namespace

TEST_CASE("a spring at a node touches it alone, one between nodes the six around it") {
  const Model at_node = model_with("  - {rod: rod, at: 0.3, spring: {stiffness: 5}}\n");
  CHECK(count<PointSpring<2, 1>>(at_node) == 1);
  CHECK(build_pattern(at_node).half_bandwidth == 5);
  const Model between = model_with("  - {rod: rod, at: 0.33, spring: {stiffness: 5}}\n");
  CHECK(count<PointSpring<2, 6>>(between) == 1);
  CHECK(build_pattern(between).half_bandwidth == 11);
  CHECK(energies(between, initial_state(between)).total() < 1e-30);
}

TEST_CASE("springs against turning at one place are one element") {
  const Model model = model_with(
      "  - {rod: rod, at: end, spring: {rotational_stiffness: 2}}\n"
      "  - {rod: rod, at: {node: -1}, spring: {rotational_stiffness: 3}}\n"
      "  - {rod: rod, at: 0.5, spring: {rotational_stiffness: 3}}\n");
  CHECK(model.rods.front().moment_places.size() == 2);
  CHECK(count<RotationalSpring<2>>(model) == 2);
  CHECK(model.rods.front().moment_place_at(1.0)->stiffness == doctest::Approx(5.0));
  CHECK(model.rods.front().moment_place_at(0.4) == nullptr);
}

// The sanitizers see what is read beyond the curvature of the last node.
TEST_CASE("springs on rings read natural curvatures of their nodes alone") {
  for (const bool flat : {true, false}) {
    const std::string z = flat ? "" : ", 0";
    const std::string curvature = flat ? "1.2" : "[1.2, 0.1]";
    const Model model = build_model(
        Scenario::parse("rods:\n  - name: rod\n    closed: true\n    points: [[1, 0" + z +
                        "], [0, 1" + z + "], [-1, 0" + z + "], [0, -1" + z +
                        "]]\n    natural_curvature: [" + curvature + ", " + curvature + ", " +
                        curvature + ", " + curvature +
                        "]\n    cross_section: {stiffness: {EA: 1e3, EI: 1, GJ: 1, "
                        "mass_per_length: 1}}\nanalysis: static\nmodel: " +
                        (flat ? "planar" : "spatial") +
                        "\nsupports:\n  - {rod: rod, at: 0.3, spring: {rotational_stiffness: 2}}\n")
            .scene());
    CHECK(energies(model, initial_state(model)).total() < 10.0);
  }
}

TEST_CASE("a spring holds the part that it pulls, along its own axes only") {
  const Model model = model_with("  - {rod: rod, at: 0.33, spring: {stiffness: [0, 5]}}\n");
  Vector force = Vector::Zero(model.num_dofs());
  force[model.dof(4, 1)] = 1.0;
  CHECK(find_unheld_part(model, force).empty());
  force[model.dof(4, 0)] = 1.0;
  CHECK(find_unheld_part(model, force).find("no support holds rod 'rod' in x") == 0);
}

TEST_CASE("a stiff spring limits the explicit step") {
  const Model soft = model_with("  - {rod: rod, at: end, spring: {stiffness: 5}}\n");
  const Model stiff = model_with("  - {rod: rod, at: end, spring: {stiffness: 1e9}}\n");
  CHECK(stable_step(soft, soft.initial_positions, false).limited_by == "stretch");
  const StableStep limit = stable_step(stiff, stiff.initial_positions, false);
  CHECK(limit.limited_by == "spring");
  CHECK(limit.worst_dof / 2 == 10);
}

TEST_CASE("a soft spring may give way far beyond the size of the rod") {
  const std::string load = "loads:\n  - point_force: {rod: rod, at: end, force: [0, -10]}\n";
  Simulation simulation(
      Scenario::parse(scene_with("  - {rod: rod, at: start, spring: {stiffness: 1e-3}}\n") + load));
  simulation.equilibrium();
  // It hangs from its start on a spring that is 10 / 1e-3 m long.
  CHECK(simulation.state().positions[1] == doctest::Approx(-1e4).epsilon(1e-9));
}

}  // namespace der::test
