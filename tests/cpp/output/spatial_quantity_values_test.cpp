// Every quantity along a rod in space, and every energy, against a value worked out by hand, on one
// configuration in which none of them is zero. Writhe and link of rings are compared with polygons
// of known ones in tests/validation/test_rings.py.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "der/catalog/quantities.hpp"
#include "der/output/probe.hpp"
#include "der/simulation.hpp"

namespace der::test {
namespace {

constexpr int kEdges = 20;
constexpr double kLength = 1.0;
constexpr double kEdge = kLength / kEdges;
constexpr double kEA = 50.0;
constexpr double kEI1 = 2.0;
constexpr double kEI2 = 3.0;
constexpr double kGJ = 1.5;
constexpr double kMassPerLength = 3.0;
constexpr double kSpinInertia = 0.02;
const Vec3 kGravity{1.0, 2.0, -9.81};
const Vec3 kSpring{40.0, 60.0, 80.0};

// The rod is drawn as an arc of a tilted plane, its sections turned evenly about it, and has the
// natural shape of a straight rod. The configuration is the drawn shape, stretched and in motion.
constexpr double kStrain = 0.03;
constexpr double kTurn = 0.06;      // from edge to edge [rad]
constexpr double kTwist = 0.8;      // [rad/m]
constexpr double kDirector = 0.5;   // of the start, from the arc's centre towards its axis [rad]
constexpr double kSpinRate = -1.3;  // of the sections [rad/s]
constexpr double kGrow = 0.01;      // elongation by an actuation of the whole rod
const Vec2 kBend{0.4, -0.7};        // natural curvatures by one [1/m]
constexpr double kTwisted = 0.3;    // natural twist by one [rad/m]
constexpr int kNode = 7;            // where quantities along the rod are read

const Vec3 kStart{0.2, -0.1, 0.4};
const Vec3 kAlong = Vec3(2.0, -1.0, 2.0) / 3.0;  // direction of the first edge
const Vec3 kAcross = Vec3(2.0, 2.0, -1.0) / 3.0;
const Vec3 kAxis = kAlong.cross(kAcross);
const Vec3 kDrift{0.3, -0.5, 0.2};     // velocity of the start [m/s]
const Vec3 kRotation{0.7, -0.2, 0.4};  // [rad/s]

std::vector<Vec3> corners(double strain) {
  std::vector<Vec3> points{kStart};
  for (int edge = 0; edge < kEdges; ++edge) {
    const double angle = edge * kTurn;
    const Vec3 along = std::cos(angle) * kAlong + std::sin(angle) * kAcross;
    points.emplace_back(points.back() + (1.0 + strain) * kEdge * along);
  }
  return points;
}

Vec3 velocity_at(const Vec3& point) { return kDrift + kRotation.cross(point - kStart); }

std::string in_yaml(const Vec3& v) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z());
}

/// The scene with one probe, and with actuations.
std::string scene_with(const std::string& probe, const std::string& actuation = "[]") {
  std::string points;
  for (const Vec3& point : corners(0.0)) points += "      - " + in_yaml(point) + "\n";
  // Towards the arc's centre from its very start, half an edge before the middle of the first edge.
  const Vec3 normal = std::cos(0.5 * kTurn) * kAcross + std::sin(0.5 * kTurn) * kAlong;
  const Vec3 director = std::cos(kDirector) * normal + std::sin(kDirector) * kAxis;
  return fmt::format(R"(
rods:
  - name: arm
    points:
{}    cross_section:
      stiffness: {{EA: {}, EI1: {}, EI2: {}, GJ: {}, mass_per_length: {}, rotary_inertia: {}}}
      director: {}
    initial_twist: {}
    natural_curvature: [0, 0]
    natural_twist: 0
supports:
  - {{rod: arm, at: start, fix: [x, y, z]}}
  - {{rod: arm, at: end, spring: {{stiffness: {}}}}}
loads:
  - gravity: {}
actuation: {}
time: {{duration: 0.1, step: 0.01}}
output: {{probes: {{p: {{{}}}}}}}
)",
                     points, kEA, kEI1, kEI2, kGJ, kMassPerLength, kSpinInertia, in_yaml(director),
                     kTwist, in_yaml(kSpring), in_yaml(kGravity), actuation, probe);
}

/// Curvatures [1/m] of the vertex at a node towards its two directors. The section has turned from
/// the normal, which points to the arc's centre, by the angle of the start and the twist up to
/// there.
Vec2 curvatures_at(int node) {
  const double angle = kDirector + kTwist * kEdge * node;
  return kTurn / kEdge * Vec2{std::cos(angle), -std::sin(angle)};
}

/// The value of each quantity in this configuration.
std::map<std::string, double> expected_values() {
  const std::vector<Vec3> points = corners(kStrain);
  const Vec3& here = points.at(kNode);
  const Vec3 velocity = velocity_at(here);
  const Vec2 curvatures = curvatures_at(kNode);
  const Vec2 moments{kEI1 * curvatures[0], kEI2 * curvatures[1]};
  // The edges beside the node are equally long: its tangent is in the middle between theirs.
  const Vec3 tangent = (points.at(kNode + 1) - points.at(kNode - 1)).normalized();
  std::map<std::string, double> values{
      {"x", here.x()},
      {"y", here.y()},
      {"z", here.z()},
      {"vx", velocity.x()},
      {"vy", velocity.y()},
      {"vz", velocity.z()},
      {"speed", velocity.norm()},
      {"curvature", kTurn / kEdge},
      {"moment", moments.norm()},
      {"curvature_1", curvatures[0]},
      {"curvature_2", curvatures[1]},
      {"moment_1", moments[0]},
      {"moment_2", moments[1]},
      {"twist", kTwist},
      {"torque", kGJ * kTwist},
      {"tx", tangent.x()},
      {"ty", tangent.y()},
      {"tz", tangent.z()},
      {"strain", kStrain},
      {"tension", kEA * kStrain},
  };
  // Each edge is a uniform bar in rigid motion: Simpson's rule integrates the square of its
  // velocity exactly. One that a support holds has its mass at its ends (model/mass.hpp).
  const double bar = kMassPerLength * kEdge;
  double kinetic = 0.5 * kSpinInertia * kLength * kSpinRate * kSpinRate;
  double gravity = 0.0;
  for (std::size_t i = 0; i < kEdges; ++i) {
    const Vec3 middle = 0.5 * (points[i] + points[i + 1]);
    const double at_ends =
        velocity_at(points[i]).squaredNorm() + velocity_at(points[i + 1]).squaredNorm();
    const double at_middle = velocity_at(middle).squaredNorm();
    kinetic += 0.5 * bar * (i == 0 ? at_ends / 2.0 : (at_ends + 4.0 * at_middle) / 6.0);
    gravity -= bar * kGravity.dot(middle);
  }
  const double stretch = 0.5 * kEA * kStrain * kStrain * kLength;
  double bend = 0.0;
  for (int node = 1; node < kEdges; ++node) {
    const Vec2 squares = curvatures_at(node).cwiseAbs2();
    bend += 0.5 * kEdge * (kEI1 * squares[0] + kEI2 * squares[1] + kGJ * kTwist * kTwist);
  }
  const Vec3 pulled = points.back() - corners(0.0).back();  // from where the spring is slack
  const double spring = 0.5 * kSpring.dot(pulled.cwiseAbs2());
  // Actuations do work against the moments of all vertices, and against the tension of all edges.
  Vec2 mean = Vec2::Zero();
  for (int node = 1; node < kEdges; ++node) mean += curvatures_at(node) / kEdges;
  const double vertices = static_cast<double>(kEdges - 1) / kEdges;
  values["natural_curvature_1"] = kBend[0];
  values["natural_curvature_2"] = kBend[1];
  values["natural_twist"] = kTwisted;
  values["actuation_moment_1"] = -kEI1 * (mean[0] - vertices * kBend[0]);
  values["actuation_moment_2"] = -kEI2 * (mean[1] - vertices * kBend[1]);
  values["actuation_torque"] = -kGJ * vertices * (kTwist - kTwisted);
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

/// An actuation of the whole rod, of the kind that a quantity tells of.
std::string actuation_for(const Quantity& quantity) {
  std::string value;
  if (quantity.name == "natural_twist" || quantity.actuates == "natural_twist") {
    value = fmt::format("natural_twist: {}", kTwisted);
  } else if (quantity.actuates == "elongation") {
    value = fmt::format("elongation: {}", kGrow);
  } else {
    value = fmt::format("natural_curvature: [{}, {}]", kBend[0], kBend[1]);
  }
  return "[{name: a, rod: arm, " + value + "}]";
}

/// The value that a probe reads in the configuration.
double probe_value(const std::string& probe, const std::string& actuation = "[]") {
  Simulation simulation(Scenario::parse(scene_with(probe, actuation)));
  const Model& model = simulation.model();
  State& state = simulation.state();
  const std::vector<Vec3> points = corners(kStrain);
  const RodMesh& rod = model.rods.at(0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Index dof = model.dof(rod.nodes[i], 0);
    state.positions.segment<3>(dof) = points[i];
    state.velocities.segment<3>(dof) = velocity_at(points[i]);
  }
  for (Index edge = 0; edge < kEdges; ++edge) state.velocities[model.dofs.angle(edge)] = kSpinRate;
  const auto probes = make_probes(simulation.scenario().scene(), model);
  return probes.at(0).value(model, state);
}

}  // namespace

TEST_CASE("every quantity of a rod in space has the value worked out by hand") {
  const std::map<std::string, double> expected = expected_values();
  const Simulation simulation(Scenario::parse(scene_with("rod: arm, at: end, quantity: x")));
  for (const Quantity& quantity : quantities()) {
    if (!is_available(quantity, simulation.model())) continue;
    if (quantity.kind == QuantityKind::Ring || quantity.read_reaction != nullptr) continue;
    if (quantity.kind == QuantityKind::Joint || quantity.kind == QuantityKind::Spring)
      continue;  // tests/validation/test_spatial_networks.py, test_springs_between_joints.py
    CAPTURE(quantity.name);
    const auto value = expected.find(quantity.name);
    const bool is_known = value != expected.end() && value->second != 0.0;
    CHECK_MESSAGE(is_known, "give expected_values() a value of this quantity, not zero");
    if (!is_known) continue;
    if (quantity.kind == QuantityKind::Natural || quantity.kind == QuantityKind::Actuation) {
      const bool is_of_rod = quantity.actuates.empty();
      const std::string where = is_of_rod ? "rod: arm, at: 0.43" : "actuation: a";
      CHECK(probe_value("quantity: " + quantity.name + ", " + where, actuation_for(quantity)) ==
            doctest::Approx(value->second).epsilon(1e-11));
      continue;
    }
    std::string probe = "rod: arm, quantity: " + quantity.name;
    if (quantity.kind != QuantityKind::Energy) probe += fmt::format(", at: {{node: {}}}", kNode);
    CHECK(probe_value(probe) == doctest::Approx(value->second).epsilon(1e-11));
  }
}

}  // namespace der::test
