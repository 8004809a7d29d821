// Every row of the table of quantities against a value worked out by hand, on one configuration in
// which none of them is zero.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "der/catalog/quantities.hpp"
#include "der/output/probe.hpp"
#include "der/simulation.hpp"

namespace der::test {
namespace {

// The rod, and its support by a spring at the end.
constexpr int kEdges = 20;
constexpr double kLength = 1.0;
constexpr double kEA = 50.0;
constexpr double kEI = 2.0;
constexpr double kMassPerLength = 3.0;
constexpr double kGravity = 9.81;
constexpr double kSpringX = 40.0;
constexpr double kSpringY = 60.0;
constexpr double kWrist = 5.0;  // against turning at the start, where its moment is read
constexpr double kBend = 0.4;   // natural curvature by an actuation of the whole rod [1/m]
constexpr double kGrow = 0.01;  // elongation by another

// The configuration: a stretched polygon whose corners all turn by the same angle, in rigid motion.
constexpr double kStrain = 0.03;
constexpr double kTurn = 0.06;       // from edge to edge [rad]
constexpr double kDirection = -0.4;  // of the first edge [rad]
constexpr double kSpin = 0.7;        // [rad/s]
constexpr int kNode = 7;             // where quantities along the rod are read

const Vec2 kStart{0.2, -0.1};
const Vec2 kDrift{0.3, -0.5};  // velocity of the start [m/s]

const std::string kScene = R"(
rods:
  - name: arm
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 50, EI: 2, mass_per_length: 3}}
supports:
  - {rod: arm, at: start, fix: [x, y]}
  - {rod: arm, at: end, spring: {stiffness: [40, 60]}}
loads:
  - gravity: [0, -9.81]
time: {duration: 0.1, step: 0.01}
output: {probes: {p: {)";

std::vector<Vec2> corners() {
  std::vector<Vec2> points{kStart};
  for (int edge = 0; edge < kEdges; ++edge) {
    const double angle = kDirection + edge * kTurn;
    const double length = (1.0 + kStrain) * kLength / kEdges;
    points.emplace_back(points.back() + length * Vec2{std::cos(angle), std::sin(angle)});
  }
  return points;
}

Vec2 velocity_at(const Vec2& point) {
  const Vec2 arm = point - kStart;
  return kDrift + kSpin * Vec2{-arm.y(), arm.x()};
}

/// The value of each quantity in this configuration.
std::map<std::string, double> expected_values() {
  const std::vector<Vec2> points = corners();
  const double edge_length = kLength / kEdges;
  const Vec2& here = points.at(kNode);
  std::map<std::string, double> values{
      {"x", here.x()},
      {"y", here.y()},
      {"vx", velocity_at(here).x()},
      {"vy", velocity_at(here).y()},
      {"speed", velocity_at(here).norm()},
      {"turning_angle", kTurn},
      {"slope", kDirection + (kNode - 0.5) * kTurn},
      {"tx", std::cos(kDirection + (kNode - 0.5) * kTurn)},
      {"ty", std::sin(kDirection + (kNode - 0.5) * kTurn)},
      {"curvature", kTurn / edge_length},
      {"moment", kEI * kTurn / edge_length},
      {"strain", kStrain},
      {"tension", kEA * kStrain},
  };
  // Each edge is a uniform bar in rigid motion: Simpson's rule integrates the square of its
  // velocity exactly. One that a support holds has its mass at its ends (model/mass.hpp).
  const double bar = kMassPerLength * edge_length;
  double kinetic = 0.0;
  double gravity = 0.0;
  for (std::size_t i = 0; i < kEdges; ++i) {
    const Vec2 middle = 0.5 * (points[i] + points[i + 1]);
    const double at_ends =
        velocity_at(points[i]).squaredNorm() + velocity_at(points[i + 1]).squaredNorm();
    const double at_middle = velocity_at(middle).squaredNorm();
    kinetic += 0.5 * bar * (i == 0 ? at_ends / 2.0 : (at_ends + 4.0 * at_middle) / 6.0);
    gravity += bar * kGravity * middle.y();
  }
  const double stretch = 0.5 * kEA * kStrain * kStrain * kLength;
  const double bend = (kEdges - 1) * 0.5 * kEI / edge_length * kTurn * kTurn;
  const Vec2 pulled = points.back() - Vec2{kLength, 0.0};  // from where the spring is slack
  const double spring =
      0.5 * (kSpringX * pulled.x() * pulled.x() + kSpringY * pulled.y() * pulled.y());
  // The pin pulls the first edge and carries the shear of the vertex behind it, and the weight of
  // half an edge. At the start of a run it has no acceleration.
  const Vec2 along = (points[1] - points[0]).normalized();
  const Vec2 across{-along.y(), along.x()};
  const double length = (1.0 + kStrain) * edge_length;
  const Vec2 pull = -kEA * kStrain * along + kEI * kTurn / edge_length / length * across;
  values["reaction_x"] = pull.x();
  values["reaction_y"] = pull.y() + 0.5 * bar * kGravity;
  // A spring against turning at the start is in series with the rod up to the edges that it turns
  // (docs/mechanics.md, "Springs").
  const double turned = 13.0 / 12.0 * kDirection - 1.0 / 12.0 * (kDirection + kTurn);
  const double cell = 47.0 / 144.0 * edge_length;
  values["reaction_moment"] = -turned / (1.0 / kWrist + cell / kEI);
  // Actuations do work against the moment of all vertices, and against the tension of all edges.
  values["natural_curvature"] = kBend;
  values["actuation_moment"] = -kEI * (kTurn / edge_length - kBend) * (kEdges - 1) / kEdges;
  values["actuation_force"] = -kEA * (kStrain - kGrow);
  values["kinetic_energy"] = kinetic;
  values["stretch_energy"] = stretch;
  values["bend_energy"] = bend;
  values["spring_energy"] = spring;
  values["gravity_energy"] = gravity;
  values["elastic_energy"] = stretch + bend + spring;
  values["total_energy"] = kinetic + stretch + bend + spring + gravity;
  return values;
}

/// The value that a probe reads in the configuration, of a rod with more supports or actuations.
double probe_value(const std::string& probe, const std::string& more = {}) {
  std::string scene = kScene + probe + "}}}\n";
  scene.insert(scene.find("loads:"), more);
  Simulation simulation(Scenario::parse(scene));
  const std::vector<Vec2> points = corners();
  const RodMesh& rod = simulation.model().rods.at(0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Index dof = simulation.model().dof(rod.nodes[i], 0);
    simulation.state().positions.segment<2>(dof) = points[i];
    simulation.state().velocities.segment<2>(dof) = velocity_at(points[i]);
  }
  const auto probes = make_probes(simulation.scenario().scene(), simulation.model());
  return probes.at(0).value(simulation.model(), simulation.state());
}

}  // namespace

TEST_CASE("every quantity of a planar rod has the value worked out by hand") {
  const std::map<std::string, double> expected = expected_values();
  for (const Quantity& quantity : quantities()) {
    if (quantity.scope > QuantityScope::Planar) continue;
    if (quantity.kind == QuantityKind::Joint) continue;   // model/joints_test.cpp
    if (quantity.kind == QuantityKind::Spring) continue;  // tests/validation/test_networks.py
    CAPTURE(quantity.name);
    const auto value = expected.find(quantity.name);
    const bool is_known = value != expected.end() && value->second != 0.0;
    CHECK_MESSAGE(is_known, "give expected_values() a value of this quantity, not zero");
    if (!is_known) continue;
    std::string probe = "quantity: " + quantity.name;
    if (quantity.kind == QuantityKind::Energy) {
      CHECK(probe_value(probe) == doctest::Approx(value->second).epsilon(1e-12));
      probe += ", rod: arm";
    } else if (quantity.name == "reaction_moment") {
      const std::string wrist = "  - {rod: arm, at: start, spring: {rotational_stiffness: 5}}\n";
      CHECK(probe_value(probe + ", support: 2", wrist) ==
            doctest::Approx(value->second).epsilon(1e-12));
      continue;
    } else if (quantity.kind == QuantityKind::Natural || !quantity.actuates.empty()) {
      const std::string where =
          quantity.actuates.empty() ? ", rod: arm, at: 0.43" : ", actuation: a";
      const std::string actuation =
          quantity.actuates == "elongation"
              ? fmt::format("actuation: [{{name: a, rod: arm, elongation: {}}}]\n", kGrow)
              : fmt::format("actuation: [{{name: a, rod: arm, natural_curvature: {}}}]\n", kBend);
      CHECK(probe_value(probe + where, actuation) == doctest::Approx(value->second).epsilon(1e-12));
      continue;
    } else if (quantity.kind == QuantityKind::Support) {
      probe += ", support: 0";
    } else {
      probe += ", rod: arm, at: {node: " + std::to_string(kNode) + "}";
    }
    CHECK(probe_value(probe) == doctest::Approx(value->second).epsilon(1e-12));
  }
}

TEST_CASE("every quantity is made in one way") {
  for (const Quantity& quantity : quantities()) {
    CAPTURE(quantity.name);
    const bool is_energy = quantity.kind == QuantityKind::Energy;
    const bool is_of_ring = quantity.kind == QuantityKind::Ring;
    const bool is_of_support = quantity.kind == QuantityKind::Support;
    const bool is_of_actuation = quantity.kind == QuantityKind::Actuation;
    const bool is_of_joint = quantity.kind == QuantityKind::Joint;
    const bool is_of_spring = quantity.kind == QuantityKind::Spring;
    CHECK((quantity.make_field == nullptr) == (is_energy || is_of_ring || is_of_support ||
                                               is_of_actuation || is_of_joint || is_of_spring));
    CHECK((quantity.read_spring != nullptr) == is_of_spring);
    CHECK((quantity.of_joint != JointQuantity::None) == is_of_joint);
    CHECK((quantity.read_actuation != nullptr) == is_of_actuation);
    CHECK(quantity.actuates.empty() != is_of_actuation);
    CHECK((quantity.read_reaction != nullptr) == is_of_support);
    CHECK((quantity.read_rod != nullptr) == is_of_ring);
    CHECK(quantity.energies.empty() != is_energy);
    CHECK(find_quantity(quantity.name) == &quantity);
  }
}

}  // namespace der::test
