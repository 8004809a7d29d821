// Every probe quantity against a value worked out by hand or by another way.
#include "der/output/probe.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "der/catalog/quantities.hpp"
#include "der/simulation.hpp"
#include "output/output_scenes.hpp"

namespace der::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// The value of one probe of the cantilever scene after `change` has been applied to its state.
template <class Change>
double probe_after(const std::string& probe, Change&& change,
                   const std::vector<Override>& overrides = {}) {
  Simulation simulation(cantilever("p: {" + probe + "}", overrides));
  change(simulation);
  const auto probes = make_probes(simulation.scenario().scene(), simulation.model());
  return probes.at(0).value(simulation.model(), simulation.state());
}

/// Puts node i of the only rod at f(s), s its rest arc length.
template <class F>
auto place(F&& f) {
  return [f](Simulation& simulation) {
    const RodMesh& rod = simulation.model().rods.at(0);
    for (std::size_t i = 0; i < rod.nodes.size(); ++i) {
      simulation.state().positions.segment<2>(2 * rod.nodes[i]) = f(rod.arc_length[i]);
    }
  };
}

/// The circle of radius `radius` that leaves the origin along x and turns counter-clockwise.
Vec2 on_circle(double s, double radius) {
  return {radius * std::sin(s / radius), radius * (1.0 - std::cos(s / radius))};
}

const auto kSettle = [](Simulation& simulation) { simulation.equilibrium(); };

Vec2 cubic(double s) { return {s, 1.0 - 2.0 * s + 3.0 * s * s - 4.0 * s * s * s}; }

}  // namespace

TEST_CASE("every quantity of the table can be read") {
  for (const Quantity& quantity : quantities()) {
    if (quantity.scope > QuantityScope::Planar || quantity.read_reaction != nullptr) continue;
    if (quantity.read_actuation != nullptr || quantity.kind == QuantityKind::Joint) continue;
    if (quantity.read_spring != nullptr) continue;
    CAPTURE(quantity.name);
    std::string probe = "quantity: " + quantity.name;
    if (quantity.kind != QuantityKind::Energy) probe += ", rod: arm, at: {node: 3}";
    CHECK(std::isfinite(probe_after(probe, kSettle)));
    if (quantity.kind == QuantityKind::Energy) continue;
    const double least =
        probe_after("quantity: " + quantity.name + ", rod: arm, over: rod, reduce: min", kSettle);
    const double greatest =
        probe_after("quantity: " + quantity.name + ", rod: arm, over: rod, reduce: max", kSettle);
    CHECK(least <= greatest);
  }
}

TEST_CASE("positions between nodes are exact for cubics, at the ends as inside") {
  for (const double s : {0.0, 0.013, 0.05, 0.333, 0.5, 0.987, 1.0}) {
    CAPTURE(s);
    const std::string where = "rod: arm, at: " + std::to_string(s);
    CHECK(probe_after(where + ", quantity: y", place(cubic)) ==
          doctest::Approx(cubic(s).y()).epsilon(1e-12));
    CHECK(probe_after(where + ", quantity: x", place(cubic)) == doctest::Approx(s).epsilon(1e-12));
  }
}

TEST_CASE("velocity and speed between nodes") {
  // The velocity (1 - 2 s, 0) changes its sign at 0.5; the speed has a kink there.
  const auto move = [](Simulation& simulation) {
    const RodMesh& rod = simulation.model().rods.at(0);
    for (std::size_t i = 0; i < rod.nodes.size(); ++i) {
      simulation.state().velocities[2 * rod.nodes[i]] = 1.0 - 2.0 * rod.arc_length[i];
      simulation.state().velocities[2 * rod.nodes[i] + 1] = 0.25;
    }
  };
  CHECK(probe_after("rod: arm, at: 0.51, quantity: vx", move) == doctest::Approx(-0.02));
  CHECK(probe_after("rod: arm, at: 0.51, quantity: vy", move) == doctest::Approx(0.25));
  CHECK(probe_after("rod: arm, at: 0.51, quantity: speed", move) ==
        doctest::Approx(std::hypot(0.02, 0.25)));
  CHECK(probe_after("rod: arm, quantity: speed, over: rod, reduce: max", move) ==
        doctest::Approx(std::hypot(1.0, 0.25)));
}

TEST_CASE("an extreme over a rod is that of the parabola, wherever it lies between nodes") {
  for (const double middle : {0.51, 0.52, 0.537, 0.55}) {
    CAPTURE(middle);
    const auto bow = [&](double s) { return Vec2{s, 0.3 - (s - middle) * (s - middle)}; };
    CHECK(probe_after("rod: arm, quantity: y, over: rod, reduce: max", place(bow)) ==
          doctest::Approx(0.3).epsilon(1e-13));
    // The least value is at an end: that of the node.
    CHECK(probe_after("rod: arm, quantity: y, over: rod, reduce: min", place(bow)) ==
          doctest::Approx(0.3 - middle * middle).epsilon(1e-13));
  }
  const auto straight = [](double s) { return Vec2{s, 0.0}; };
  CHECK(probe_after("rod: arm, quantity: y, over: rod, reduce: max", place(straight)) == 0.0);
}

TEST_CASE("turning angle, curvature and moment of an arc") {
  const double radius = 0.7;
  const double l = 0.05;
  const auto arc = place([&](double s) { return on_circle(s, radius); });
  const std::string node = "rod: arm, at: {node: 7}, quantity: ";
  const double phi = l / radius;
  CHECK(probe_after(node + "turning_angle", arc) == doctest::Approx(phi).epsilon(1e-12));
  CHECK(probe_after(node + "curvature", arc) == doctest::Approx(1.0 / radius).epsilon(1e-12));
  CHECK(probe_after(node + "moment", arc) == doctest::Approx(1.0 / radius).epsilon(1e-12));
  // dE/dphi of EI (2 tan(phi/2))^2 / 2l
  const double kappa = 2.0 * std::tan(0.5 * phi);
  CHECK(probe_after(node + "moment", arc, {{"rods.arm.curvature", "tangent"}}) ==
        doctest::Approx(kappa * (1.0 + 0.25 * kappa * kappa) / l).epsilon(1e-12));
  // A rod that is naturally so curved is free of moment.
  CHECK(std::abs(probe_after(node + "moment", arc,
                             {{"rods.arm.natural_curvature", std::to_string(1.0 / radius)}})) <
        1e-5);
  // Clockwise is negative.
  const auto clockwise =
      place([&](double s) { return Vec2{on_circle(s, radius).x(), -on_circle(s, radius).y()}; });
  CHECK(probe_after(node + "turning_angle", clockwise) == doctest::Approx(-phi).epsilon(1e-12));
  CHECK(probe_after("rod: arm, quantity: turning_angle, over: rod, reduce: min", clockwise) ==
        doctest::Approx(-phi).epsilon(1e-12));
}

TEST_CASE("a rod at rest in its natural curvature has that curvature up to the clamp") {
  Simulation simulation(
      cantilever("k: {rod: arm, at: start, quantity: curvature},"
                 "m: {rod: arm, at: start, quantity: moment}",
                 {{"rods.arm.natural_curvature", "0.7"}, {"loads.0.point_force.force", "[0, 0]"}}));
  simulation.equilibrium();
  const auto probes = make_probes(simulation.scenario().scene(), simulation.model());
  const auto read = [&](std::size_t i) {
    return probes[i].value(simulation.model(), simulation.state());
  };
  CHECK(read(0) == doctest::Approx(0.7).epsilon(1e-9));
  CHECK(std::abs(read(1)) < 1e-8);
}

TEST_CASE("the moment at a clamp is its reaction, whichever end it holds") {
  Simulation start(
      cantilever("m: {rod: arm, at: start, quantity: moment},"
                 "least: {rod: arm, quantity: moment, over: rod, reduce: min},"
                 "x: {rod: arm, at: end, quantity: x}"));
  start.equilibrium();
  const auto probes = make_probes(start.scenario().scene(), start.model());
  const auto read = [&](std::size_t i) { return probes[i].value(start.model(), start.state()); };
  // Carried from the clamp's cell to the node: of second order, 1e-3 with 20 elements.
  CHECK(read(0) == doctest::Approx(-1.0 * read(2)).epsilon(1e-3));
  CHECK(read(1) == doctest::Approx(read(0)).epsilon(1e-9));

  // The mirror image, drawn from its free end to the clamp.
  Simulation end(
      cantilever("m: {rod: arm, at: end, quantity: moment},"
                 "x: {rod: arm, at: start, quantity: x}",
                 {{"rods.arm.from", "[-1, 0]"},
                  {"rods.arm.to", "[0, 0]"},
                  {"supports.0.at", "end"},
                  {"loads.0.point_force.at", "start"}}));
  end.equilibrium();
  const auto mirrored = make_probes(end.scenario().scene(), end.model());
  CHECK(mirrored[0].value(end.model(), end.state()) == doctest::Approx(read(0)).epsilon(1e-9));
}

TEST_CASE("a clamp that turns is followed by its probes") {
  const auto upright = place([](double s) { return Vec2{0.0, s}; });
  const std::string quarter = std::to_string(0.5 * kPi);
  CHECK(std::abs(probe_after("rod: arm, at: start, quantity: turning_angle", upright,
                             {{"supports.0.prescribe", "{angle: " + quarter + "}"}})) < 1e-6);
}

TEST_CASE("strain and tension belong to the middles of edges and reach to the ends") {
  // Length of the edge around s: 1 + 0.1 s times its rest length.
  const auto stretch = place([](double s) { return Vec2{s + 0.05 * s * s, 0.0}; });
  for (const double s : {0.0, 0.01, 0.025, 0.5, 0.61, 1.0}) {
    CAPTURE(s);
    const std::string where = "rod: arm, at: " + std::to_string(s);
    CHECK(probe_after(where + ", quantity: strain", stretch) ==
          doctest::Approx(0.1 * s).epsilon(1e-10));
    CHECK(probe_after(where + ", quantity: tension", stretch) ==
          doctest::Approx(1e4 * 0.1 * s).epsilon(1e-10));
  }
  CHECK(probe_after("rod: arm, quantity: tension, over: rod, reduce: max", stretch) ==
        doctest::Approx(1e3).epsilon(1e-10));
  CHECK(std::abs(probe_after("rod: arm, quantity: tension, over: rod, reduce: min", stretch)) <
        1e-9);
  // One edge: the same everywhere.
  CHECK(probe_after("rod: arm, at: end, quantity: strain", stretch, {{"rods.arm.nodes", "2"}}) ==
        doctest::Approx(0.05).epsilon(1e-12));
}

TEST_CASE("energies of the model are those of the state, and its rods' sum") {
  const std::string second_rod = R"(
rods:
  - {name: a, nodes: 5, from: [0, 0], to: [1, 0],
     cross_section: {stiffness: {EA: 100, EI: 1, mass_per_length: 1}}}
  - {name: b, nodes: 4, from: [0, 2], to: [1, 2],
     cross_section: {stiffness: {EA: 300, EI: 3, mass_per_length: 2}}}
supports:
  - {rod: a, at: start, clamp: true}
loads:
  - gravity: [0, -9.81]
time: {duration: 0.1, step: 0.01}
output:
  probes:
)";
  std::string probes;
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities()) {
    if (quantity.kind != QuantityKind::Energy) continue;
    names.push_back(quantity.name);
    for (const std::string rod : {"", "a", "b"}) {
      probes += "    " + quantity.name + rod + ": {quantity: " + quantity.name +
                (rod.empty() ? "" : ", rod: " + rod) + "}\n";
    }
  }
  Simulation simulation(Scenario::parse(second_rod + probes));
  for (int i = 0; i < 5; ++i) simulation.step();
  const auto all = make_probes(simulation.scenario().scene(), simulation.model());
  const auto read = [&](std::size_t i) {
    return all[i].value(simulation.model(), simulation.state());
  };
  for (std::size_t i = 0; i < names.size(); ++i) {
    CAPTURE(names[i]);
    CHECK(read(3 * i) == doctest::Approx(read(3 * i + 1) + read(3 * i + 2)).epsilon(1e-12));
  }
  const Energies e = energies(simulation.model(), simulation.state());
  const auto expect = [&](const std::string& name, double value) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == name) CHECK(read(3 * i) == doctest::Approx(value).epsilon(1e-12));
    }
  };
  expect("kinetic_energy", e[EnergyTerm::Kinetic]);
  expect("stretch_energy", e[EnergyTerm::Stretch]);
  expect("bend_energy", e[EnergyTerm::Bend]);
  expect("elastic_energy", e.elastic());
  expect("gravity_energy", e[EnergyTerm::Gravity]);
  expect("total_energy", e.total());
  CHECK(e[EnergyTerm::Kinetic] > 0.0);
  CHECK(e[EnergyTerm::Bend] > 0.0);
}

}  // namespace der::test
