// The model that the builder makes of a scene: masses, places along a rod, clamps, tables.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "der/building/builder.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/planar_clamp.hpp"
#include "der/energies/stretch.hpp"
#include "der/model/location.hpp"
#include "der/model/node_weights.hpp"
#include "der/model/state.hpp"
#include "der/scenario/reader.hpp"
#include "der/supports/clamp.hpp"

namespace der::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// Rounding error of a few operations on numbers up to 1; doctest's own tolerance is 1e-5.
constexpr double kRounding = 1e-14;

Model model_of(const std::string& rod, const std::string& rest = "") {
  return build_model(Scenario::parse("title: test\nrods:\n  - name: rod\n" + rod + rest +
                                     "time: {duration: 1, step: 0.1}\n")
                         .scene());
}

const std::string kUneven =
    "    points: [[0, 0], [0.1, 0], [0.4, 0], [0.5, 0], [0.9, 0], [1, 0]]\n"
    "    cross_section: {circle: {radius: 0.01}}\n"
    "    material: {youngs_modulus: 1e7, density: 1000}\n";
const std::string kEven =
    "    nodes: 11\n    from: [0, 0]\n    to: [1, 0]\n"
    "    cross_section: {circle: {radius: 0.01}}\n"
    "    material: {youngs_modulus: 1e7, density: 1000}\n";
const std::string kRing =
    "    points: [[1, 0], [0.5, 0.8], [-0.5, 0.9], [-1, 0], [-0.5, -0.9], [0, -1], [0.7, -0.8]]\n"
    "    closed: true\n"
    "    cross_section: {circle: {radius: 0.01}}\n"
    "    material: {youngs_modulus: 1e7, density: 1000}\n";

}  // namespace

TEST_CASE("masses: Voronoi cells sum to the rod, spheres add to their node") {
  const Model model = model_of(kUneven +
                               "    spheres:\n"
                               "      - {at: all, radius: 0.02, density: 500}\n"
                               "      - {at: end, radius: 0.03, density: 700}\n");
  const double rod = kPi * 1e-4 * 1000.0;
  const auto sphere = [](double radius, double density) {
    return 4.0 / 3.0 * kPi * std::pow(radius, 3) * density;
  };
  CHECK(model.mass.lumped.sum() / 2.0 ==
        doctest::Approx(rod + 5.0 * sphere(0.02, 500.0) + sphere(0.03, 700.0)).epsilon(kRounding));
  CHECK(model.mass.lumped[2 * 2] ==
        doctest::Approx(rod * 0.5 * (0.3 + 0.1) + sphere(0.02, 500.0)).epsilon(kRounding));
}

TEST_CASE("weights between nodes reproduce cubics, so a load keeps its first three moments") {
  // Where an edge at an end is as long as here, two of them.
  for (const auto& [points, most] : {std::pair(kEven, 3), std::pair(kUneven, 2)}) {
    const Model model = model_of(points);
    const RodMesh& rod = model.rods.front();
    for (const double s : {0.0, 0.03, 0.1, 0.27, 0.45, 0.5, 0.77, 0.98, 1.0}) {
      for (int power = 0; power <= most; ++power) {
        double sum = 0.0;
        for (const auto& [place, weight] : node_weights(rod, s, model)) {
          sum += weight * std::pow(rod.arc_length[static_cast<std::size_t>(place)], power);
        }
        CHECK(sum == doctest::Approx(std::pow(s, power)).epsilon(10.0 * kRounding));
      }
    }
    CHECK(node_weights(rod, 0.5, model).size() == 1);
  }
}

TEST_CASE("a chain gives way to a force between nodes as the rod does") {
  // sum_ij w_i w_j |s_i - s_j|, the kink that spread forces make, is that of the rod: 0.
  const auto kink = [](const RodMesh& rod, const std::vector<Weighted>& nodes) {
    double sum = 0.0;
    for (const auto& [i, w] : nodes) {
      for (const auto& [j, v] : nodes) {
        sum += w * v * std::abs(rod.arc_length_at(i) - rod.arc_length_at(j));
      }
    }
    return sum;
  };
  const Model even = model_of(kEven);
  const Model uneven = model_of(
      "    points: [[0, 0], [0.1, 0], [0.2, 0], [0.4, 0], [0.55, 0], [0.85, 0], [1, 0]]\n"
      "    cross_section: {circle: {radius: 0.01}}\n"
      "    material: {youngs_modulus: 1e7, density: 1000}\n");
  const Model ring = model_of(kRing);
  const Model long_end = model_of(
      "    points: [[0, 0], [0.4, 0], [0.5, 0], [0.6, 0], [0.7, 0], [0.8, 0], [0.9, 0], [1, 0]]\n"
      "    cross_section: {circle: {radius: 0.01}}\n"
      "    material: {youngs_modulus: 1e7, density: 1000}\n");
  for (const Model* model : {&even, &uneven, &ring, &long_end}) {
    const RodMesh& rod = model->rods.front();
    for (const double s : {0.03, 0.07, 0.13, 0.27, 0.46, 0.57, 0.77, 0.98}) {
      const std::vector<Weighted> nodes = node_weights(rod, s * rod.rest_length(), *model);
      CHECK(nodes.size() == std::min<std::size_t>(6, rod.nodes.size()));
      CHECK(std::abs(kink(rod, nodes)) < 1e-12);
    }
  }
  // Seen from the other end it is the same.
  const RodMesh& rod = even.rods.front();
  const std::vector<Weighted> here = node_weights(rod, 0.43, even);
  const std::vector<Weighted> mirrored = node_weights(rod, 0.57, even);
  for (std::size_t i = 0; i < here.size(); ++i) {
    CHECK(here[i].weight == doctest::Approx(mirrored[here.size() - 1 - i].weight).epsilon(1e-12));
  }
}

TEST_CASE("places between nodes have no nodes beyond others on which forces act") {
  const std::string pinned = "supports:\n  - {rod: rod, at: 0.5, fix: [x, y]}\n";
  const Model model = model_of(kEven, pinned);
  const auto range = [&](double s) {
    const std::vector<Weighted> nodes = node_weights(model.rods.front(), s, model);
    return std::pair(nodes.front().place, nodes.back().place);
  };
  CHECK(range(0.43) == std::pair<Index, Index>(0, 5));
  CHECK(range(0.52) == std::pair<Index, Index>(5, 10));
  // Between two that leave fewer than four nodes it is as if they were not there.
  const Model twice = model_of(kEven, pinned + "  - {rod: rod, at: 0.7, fix: [x, y]}\n");
  CHECK(node_weights(twice.rods.front(), 0.55, twice).front().place == 3);
}

TEST_CASE("weights of edges reproduce a linear change of direction between edge midpoints") {
  const Model model = model_of(kUneven);
  const RodMesh& rod = model.rods.front();
  for (const double s : {0.1, 0.2, 0.3, 0.5, 0.9}) {
    double sum = 0.0;
    for (const auto& [edge, weight] : edge_weights(rod, s)) {
      const auto e = static_cast<std::size_t>(edge);
      sum += weight * 0.5 * (rod.arc_length[e] + rod.arc_length[e + 1]);
    }
    CHECK(sum == doctest::Approx(s).epsilon(kRounding));
  }
}

TEST_CASE(
    "a uniform rod turns about its middle with the rotary inertia m L^2/12, whatever the mesh") {
  const Model model = model_of(
      "    points: [[-0.5, 0], [-0.3, 0], [0.1, 0], [0.5, 0]]\n"
      "    cross_section: {stiffness: {EA: 1e3, EI: 1, mass_per_length: 1.2}}\n");
  Vector velocities(model.num_dofs());
  for (Index node = 0; node < model.num_nodes; ++node) {
    velocities.segment<2>(2 * node) << -model.initial_positions[2 * node + 1],
        model.initial_positions[2 * node];
  }
  const auto exact = doctest::Approx(0.5 * 1.2 / 12.0).epsilon(kRounding);
  CHECK(model.mass.kinetic_energy(velocities) == exact);
  CHECK(0.5 * velocities.dot(model.mass.momentum(velocities)) == exact);
  CHECK(velocities.dot(model.mass.lower_bound().cwiseProduct(velocities)) < 1.2 / 12.0);
}

TEST_CASE("a clamp on a drawn arc holds the arc's tangent and leaves it free of stress") {
  // A circle of radius 1 from angle 0 on: the tangent at its start points along +y.
  std::string points = "    points: [";
  for (int i = 0; i <= 40; ++i) {
    const double a = 0.02 * i;
    points += (i > 0 ? ", [" : "[") + std::to_string(std::cos(a)) + ", " +
              std::to_string(std::sin(a)) + "]";
  }
  points += "]\n    cross_section: {stiffness: {EA: 1e3, EI: 1, mass_per_length: 1}}\n";
  const Model model = model_of(points, "supports:\n  - {rod: rod, at: start, clamp: true}\n");
  // The points are written with 6 digits; over an edge of 0.02 that is 5e-5 rad.
  CHECK(initial_tangent_angle(model.rods.front(), 0, model) ==
        doctest::Approx(0.5 * kPi).epsilon(1e-4));
  CHECK(energies(model, initial_state(model)).elastic() < 1e-20);
}

TEST_CASE("a clamp inside a rod takes over the bending of its node") {
  const std::string rod =
      "    nodes: 11\n    from: [0, 0]\n    to: [1, 0]\n"
      "    cross_section: {stiffness: {EA: 1e3, EI: 1, mass_per_length: 1}}\n";
  const Model free = model_of(rod);
  const Model clamped = model_of(rod, "supports:\n  - {rod: rod, at: middle, clamp: true}\n");
  const auto count = [](const Model& model, auto kernel) {
    return elements_of<decltype(kernel)>(*model.elements).size();
  };
  CHECK(count(free, PlanarBend<AngleCurvature>{}) == 9);
  // Node 5 has none, nodes 4 and 6 bend against an edge that starts from a pivot.
  CHECK(count(clamped, PlanarBend<AngleCurvature>{}) == 6);
  CHECK(count(clamped, FromPivot<PlanarBend<AngleCurvature>>{}) == 2);
  CHECK(count(clamped, FromPivot<PlanarClamp<AngleCurvature>>{}) == 2);
  CHECK(count(clamped, FromPivot<Stretch<2>>{}) == 2);
}

TEST_CASE("a cable has no bending elements") {
  const Model model = model_of(
      "    nodes: 11\n    from: [0, 0]\n    to: [1, 0]\n"
      "    cross_section: {stiffness: {EA: 1e3, EI: 0, mass_per_length: 1}}\n");
  CHECK(elements_of<PlanarBend<AngleCurvature>>(*model.elements).size() == 0);
}

TEST_CASE("a distributed force sums to its length and stands at its middle") {
  const Model model = model_of(kUneven,
                               "loads:\n  - distributed_force: {rod: rod, from: 0.15, to: 0.8, "
                               "force: [0, -4]}\n");
  double force = 0.0;
  double moment = 0.0;
  for (Index i = 0; i < model.num_nodes; ++i) {
    force += model.dead_force[2 * i + 1];
    moment += model.dead_force[2 * i + 1] * model.initial_positions[2 * i];
  }
  CHECK(force == doctest::Approx(-4.0 * 0.65).epsilon(kRounding));
  CHECK(moment == doctest::Approx(-4.0 * 0.65 * 0.475).epsilon(kRounding));
}

TEST_CASE("tables are linear between entries and constant beyond both ends") {
  const scenario::Series series{{1.0, 2.0, 4.0}, {10.0, 20.0, 0.0}};
  CHECK(value_at(series, 0.0) == 10.0);
  CHECK(value_at(series, 1.5) == 15.0);
  CHECK(value_at(series, 2.0) == 20.0);
  CHECK(value_at(series, 3.0) == 10.0);
  CHECK(value_at(series, 9.0) == 0.0);
}

TEST_CASE("held components start in their table's place at rest, free ones with their velocity") {
  const Model model = model_of(
      "    nodes: 3\n    from: [0, 0]\n    to: [1, 0]\n"
      "    cross_section: {stiffness: {EA: 1e3, EI: 1, mass_per_length: 1}}\n"
      "    initial_velocity: [2, -1]\n",
      "supports:\n  - {rod: rod, at: start, fix: [y], prescribe: {x: {times: [0, 1], values: "
      "[0.5, 1.5]}}}\nstart_from: equilibrium\n");
  const State state = initial_state(model);
  Vector positions(6);
  positions << 0.5, 0.0, 0.5, 0.0, 1.0, 0.0;
  CHECK(state.positions == positions);
  Vector velocities(6);
  velocities << 0.0, 0.0, 2.0, -1.0, 2.0, -1.0;
  CHECK(state.velocities == velocities);
  CHECK(model.dofs.free() == std::vector<Index>{2, 3, 4, 5});
}

}  // namespace der::test
