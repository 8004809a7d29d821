// Static equilibria: found, judged, or refused with a reason.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "der/core/error.hpp"
#include "der/simulation.hpp"

namespace der::test {
namespace {

std::string scene(const std::string& supports, const std::string& force) {
  return R"(
title: Rod
rods:
  - name: rod
    nodes: 31
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1e5, EI: 1, mass_per_length: 1}}
)" + (supports.empty() ? "" : "supports:\n" + supports) +
         "loads:\n  - point_force: {rod: rod, at: end, force: " + force + "}\nanalysis: static\n";
}

/// Status and message of a failure, or what was found.
std::string failure(const std::string& text, const std::vector<Override>& overrides = {}) {
  try {
    Simulation simulation(Scenario::parse(text, "scene", overrides));
    return simulation.equilibrium().stability.name();
  } catch (const NotConvergedError& error) {
    return error.status() + ": " + error.what();
  }
}

/// Angle by which the rod's edges turn from the first to the last, without whole turns.
double total_turn(const Vector& x) {
  double turn = 0.0;
  for (Index i = 4; i + 1 < x.size(); i += 2) {
    const Vec2 before = x.segment<2>(i - 2) - x.segment<2>(i - 4);
    const Vec2 after = x.segment<2>(i) - x.segment<2>(i - 2);
    turn += std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
  }
  return turn;
}

const std::string kClamp = "  - {rod: rod, at: start, clamp: true}\n";

}  // namespace

TEST_CASE("the number of unstable directions tells a buckled column from a straight one") {
  // Clamped-free: buckles at pi^2/4 EI/L^2 = 2.467, and a second time at 9 pi^2/4 = 22.2.
  const auto unstable = [](const std::string& force) {
    return Simulation(Scenario::parse(scene(kClamp, force)))
        .equilibrium(false)
        .stability.unstable_directions;
  };
  CHECK(unstable("[-2.4, 0]") == 0);
  CHECK(unstable("[-2.6, 0]") == 1);
  CHECK(unstable("[-22.6, 0]") == 2);
}

TEST_CASE("a saddle is left for the buckled shape, and said so") {
  Simulation simulation(Scenario::parse(scene(kClamp, "[-2.6, 0]")));
  const EquilibriumReport report = simulation.equilibrium();
  CHECK(report.saddles_left == 1);
  CHECK(report.stability.name() == std::string("stable"));
  CHECK(report.residual <= 1e-6 * report.force_scale);
  const Vector& x = simulation.state().positions;
  CHECK(std::abs(x[x.size() - 1]) > 0.1);
}

TEST_CASE("the state of lower potential is taken of the two beside a saddle") {
  // A pinned rod that the force stands on its head falls to the side and hangs along the force.
  Simulation simulation(
      Scenario::parse(scene("  - {rod: rod, at: start, fix: [x, y]}\n", "[-0.5, 0]")));
  const EquilibriumReport report = simulation.equilibrium();
  CHECK(report.saddles_left == 1);
  const Vector& x = simulation.state().positions;
  CHECK(x[x.size() - 2] == doctest::Approx(-(1.0 + 0.5 / 1e5)).epsilon(1e-9));
}

TEST_CASE("what has no equilibrium fails with a name") {
  const std::string pin = "  - {rod: rod, at: start, fix: [x, y]}\n";
  const std::string unheld = failure(scene("  - {rod: rod, at: end, fix: [y]}\n", "[3, 0]"));
  CHECK(unheld.rfind("not_held: ", 0) == 0);
  CHECK(unheld.find("no support holds rod 'rod' in x, and 3 N act") != std::string::npos);

  std::string turning = scene(pin, "[0, 0]");
  turning.replace(turning.find("analysis"), 0, "  - moment: {rod: rod, at: end, moment: 1}\n");
  CHECK(failure(turning).rfind("unbounded: ", 0) == 0);

  std::string pressed = scene(kClamp +
                                  "  - {rod: rod, at: middle, fix: [y]}\n"
                                  "  - {rod: rod, at: end, fix: [y]}\n",
                              "[-30, 0]");
  pressed.replace(pressed.find("EA: 1e5"), 7, "EA: 20 ");
  CHECK(failure(pressed).rfind("collapsed: ", 0) == 0);
}

TEST_CASE("a body that is free and in balance has neutral directions, not a failure") {
  Simulation simulation(Scenario::parse(scene("", "[0, 0]")));
  const EquilibriumReport report = simulation.equilibrium();
  CHECK(report.stability.name() == std::string("neutral"));
  CHECK(report.stability.neutral_directions == 3);
  CHECK(report.stability.unstable_directions == 0);
}

TEST_CASE("very stiff stretching costs no digits of the bending") {
  // Both are practically inextensible: strains are 2e-9 and less.
  const auto tip = [](const std::string& EA) {
    Simulation simulation(Scenario::parse(scene(kClamp, "[0, -2]"), "scene",
                                          {{"rods.rod.cross_section.stiffness.EA", EA}}));
    simulation.equilibrium();
    const Vector& x = simulation.state().positions;
    return x[x.size() - 1];
  };
  CHECK(tip("1e10") == doctest::Approx(tip("1e9")).epsilon(3e-9));
}

TEST_CASE("the forces balance: the residual on held nodes is the reaction") {
  Simulation simulation(Scenario::parse(scene(kClamp, "[0, -10]")));
  const EquilibriumReport report = simulation.equilibrium();
  CHECK(report.residual <= 1e-9 * report.force_scale);
  CHECK(report.force_scale == doctest::Approx(10.0).epsilon(1e-6));

  // The gradient at the clamped node is the reaction of the support, which balances the load.
  const Model& model = simulation.model();
  Vector gradient(model.num_dofs());
  const Pattern pattern = build_pattern(model);
  Assembler(model, MatrixLayout::compressed(pattern))
      .gradient(configuration_of(model, simulation.state()), gradient);
  // As many residuals as there are nodes may add up.
  const double left = static_cast<double>(model.num_nodes) * report.residual + 1e-12 * 10.0;
  CHECK((gradient.head<2>() - Vec2{0.0, 10.0}).lpNorm<Eigen::Infinity>() <= left);
  CHECK(left < 1e-6);
}

TEST_CASE("a structure that nothing holds has no equilibrium") {
  Simulation simulation(Scenario::parse(scene("", "[0, -1]")));
  CHECK_THROWS_AS(simulation.equilibrium(), NotConvergedError);
  CHECK(simulation.state().positions == simulation.model().initial_positions);
}

TEST_CASE("a rod that hangs from a pin finds its way down") {
  Simulation simulation(
      Scenario::parse(scene("  - {rod: rod, at: start, fix: [x, y]}\n", "[0, -3]")));
  CHECK(simulation.equilibrium().stability.name() == std::string("stable"));
  const Vector& x = simulation.state().positions;
  CHECK(x[x.size() - 2] == doctest::Approx(0.0).epsilon(1e-6));
  // Hooke's law: 3 N stretch the metre by 3 / EA.
  CHECK(x[x.size() - 1] == doctest::Approx(-(1.0 + 3.0 / 1e5)).epsilon(1e-9));
}

TEST_CASE("a saddle is known where the assembled stiffness drowns its softest eigenvalue") {
  // Pinned, at 1.5 times its buckling load; the elastica's midpoint lies at 0.39425 there.
  const std::string pinned =
      "  - {rod: rod, at: start, fix: [x, y]}\n  - {rod: rod, at: end, fix: [y]}\n";
  const auto buckled = [&](const std::string& EA, const std::string& nodes) {
    CAPTURE(EA);
    CAPTURE(nodes);
    Simulation simulation(
        Scenario::parse(scene(pinned, "[-14.8, 0]"), "scene",
                        {{"rods.rod.cross_section.stiffness.EA", EA}, {"rods.rod.nodes", nodes}}));
    const EquilibriumReport report = simulation.equilibrium();
    CHECK(report.saddles_left == 1);
    CHECK(report.stability.name() == std::string("stable"));
    const Vector& x = simulation.state().positions;
    CHECK(std::abs(x[x.size() / 2]) == doctest::Approx(0.39425).epsilon(1e-3));
  };
  buckled("1e14", "51");
  buckled("1e10", "2001");
  buckled("1e6", "10001");
}

TEST_CASE("a fine or stiff cantilever is stable, not neutral") {
  // The elastica's tip under 1 EI/L^2: (0.943567, -0.301721).
  const auto check = [](const std::string& EA, const std::string& nodes) {
    CAPTURE(EA);
    CAPTURE(nodes);
    Simulation simulation(
        Scenario::parse(scene(kClamp, "[0, -1]"), "scene",
                        {{"rods.rod.cross_section.stiffness.EA", EA}, {"rods.rod.nodes", nodes}}));
    CHECK(simulation.equilibrium().stability.name() == std::string("stable"));
    const Vector& x = simulation.state().positions;
    CHECK(x[x.size() - 1] == doctest::Approx(-0.301721).epsilon(1e-5));
  };
  check("1e10", "1001");
  check("1e6", "10001");
}

TEST_CASE("beyond double precision no shape is given that is none") {
  // The tension of one edge is known to EA/l times the rounding of a coordinate: more than the
  // load.
  std::string inclined = scene(kClamp, "[0, -1]");
  inclined.replace(inclined.find("to: [1, 0]"), 10, "to: [0.6, 0.8]");
  const auto outcome = [&](const std::string& EA, const std::string& nodes) {
    return failure(inclined,
                   {{"rods.rod.cross_section.stiffness.EA", EA}, {"rods.rod.nodes", nodes}});
  };
  CHECK(outcome("1e15", "1001").rfind("too_fine: ", 0) == 0);
  CHECK(outcome("1e16", "201").rfind("too_fine: ", 0) == 0);
}

TEST_CASE("what holds a rod too weakly for double precision is named, not the mesh") {
  const auto outcome = [](const std::string& supports, const std::string& loads) {
    std::string text = scene(supports, "[0, -1e-12]");
    return failure(text.replace(text.find("analysis"), 0, loads));
  };
  const auto holds = [](const std::string& message, const std::string& part) {
    return message.find(part) != std::string::npos;
  };
  const auto foundation = [](const std::string& stiffness) {
    return "  - foundation: {rod: rod, stiffness: " + stiffness + "}\n";
  };
  const std::string moved = outcome("", foundation("[1, 1e-30]"));
  CHECK(moved.rfind("not_held: ", 0) == 0);
  CHECK(holds(
      moved, "springs or foundations alone hold rod 'rod' against moving along y, with 1e-30 N/m"));
  const std::string pinned = "  - {rod: rod, at: start, fix: [x, y]}\n";
  const std::string turned = outcome(pinned, foundation("1e-30"));
  CHECK(turned.rfind("not_held: ", 0) == 0);
  CHECK(holds(turned, "against turning"));
  const std::string spring = "  - {rod: rod, at: middle, spring: {stiffness: [1, 1e-30]}}\n";
  CHECK(holds(outcome(spring, foundation("[1, 1e-30]")), "against moving along y, with 2e-30 N/m"));
  // Another part that is held well is not blamed, and a foundation that can be resolved is enough.
  CHECK(outcome(kClamp, foundation("1e-30")) == "stable");
  CHECK(outcome("", foundation("1e-3")) == "stable");
}

TEST_CASE("what holds a rod in space too weakly is named") {
  const auto outcome = [](const std::string& supports, const std::string& loads) {
    std::string text = scene(supports, "[0, 0, -1e-12]");
    text.replace(text.find("EI: 1,"), 6, "EI1: 1, EI2: 1, GJ: 1,");
    text.replace(text.find("[0, 0]"), 6, "[0, 0, 0]").replace(text.find("[1, 0]"), 6, "[1, 0, 0]");
    return failure(text.replace(text.find("analysis"), 0, loads));
  };
  const auto holds = [](const std::string& message, const std::string& part) {
    return message.find(part) != std::string::npos;
  };
  const std::string foundation = "  - foundation: {rod: rod, stiffness: [1, 1, 1e-30]}\n";
  const std::string turned = "  - {rod: rod, at: middle, spring: {rotational_stiffness: 1}}\n";
  const std::string moved = outcome(turned, foundation);
  CHECK(moved.rfind("not_held: ", 0) == 0);
  CHECK(holds(moved, "hold rod 'rod' against moving along z, with 1e-30 N/m"));
  const std::string tipped = outcome("  - {rod: rod, at: start, fix: [x, y, z]}\n",
                                     "  - foundation: {rod: rod, stiffness: 1e-30}\n");
  CHECK(tipped.rfind("not_held: ", 0) == 0);
  CHECK(holds(tipped, "against turning about "));
  CHECK(outcome(kClamp, foundation) == "stable");
}

TEST_CASE("a clamp that turns takes the rod along, beyond half a turn too") {
  // At the other end, which slides, a stiff spring holds the drawn direction: from there to here
  // the rod turns by the whole angle, but for the half cells at the ends.
  const auto turned = [](const std::string& angle) {
    return Scenario::parse(
        scene("  - {rod: rod, at: start, clamp: true, prescribe: {angle: " + angle +
                  "}}\n  - {rod: rod, at: end, fix: [y], spring: {rotational_stiffness: 1e6}}\n",
              "[0, 0]"));
  };
  for (const double angle : {2.5, 3.3, 5.0, 6.283185307179586}) {
    CAPTURE(angle);
    Simulation simulation(turned(fmt::format("{}", angle)));
    CHECK(simulation.equilibrium().stability.name() == std::string("stable"));
    CHECK(total_turn(simulation.state().positions) == doctest::Approx(-angle).epsilon(0.05));
  }
  // From shape to shape it goes the shorter way.
  Simulation simulation(turned("2.5"));
  simulation.equilibrium();
  simulation.prescribe(0, "angle", 4.0);
  simulation.equilibrium();
  CHECK(total_turn(simulation.state().positions) == doctest::Approx(-4.0).epsilon(0.05));
}

TEST_CASE("a clamp whose edge folds over instead of following is no equilibrium of its angle") {
  // EA L^2/EI = 1e6: taut between two clamps, the rod bends within less than an edge.
  const std::string taut =
      "  - {rod: rod, at: start, clamp: true, prescribe: {angle: 5}}\n"
      "  - {rod: rod, at: end, clamp: true}\n";
  const std::string outcome =
      failure(scene(taut, "[0, 0]"),
              {{"rods.rod.cross_section.stiffness.EA", "1e6"}, {"rods.rod.nodes", "81"}});
  CHECK(outcome.rfind("folded: ", 0) == 0);
}

TEST_CASE("a rod that its load could crush gives way to the side") {
  // EA is little more than the load: pressed straight, a tenth of the length is left.
  for (const std::string force : {"[-450, 0]", "[-4000, 0]"}) {
    CAPTURE(force);
    Simulation simulation(Scenario::parse(
        scene(kClamp, force), "scene",
        {{"rods.rod.cross_section.stiffness.EA", "500"}, {"rods.rod.nodes", "33"}}));
    CHECK(simulation.equilibrium().stability.name() == std::string("stable"));
    // It hangs from the clamp along the force.
    const Vector& x = simulation.state().positions;
    CHECK(x[x.size() - 2] < -1.0);
  }
}

TEST_CASE("a rod is not turned inside out") {
  // Guided along x it cannot give way: the load would press it through zero length.
  const std::string guided =
      "  - {rod: rod, at: start, fix: [x, y]}\n  - {rod: rod, at: end, fix: [y]}\n";
  const std::string outcome =
      failure(scene(guided, "[-2, 0]"),
              {{"rods.rod.cross_section.stiffness.EA", "1"}, {"rods.rod.nodes", "2"}});
  CHECK(outcome.rfind("collapsed: ", 0) == 0);
}

TEST_CASE("a rod pressed onto the pivot of its clamp has collapsed, in the plane and in space") {
  // A weight of nine times EA. The edge at a clamp stretches from a pivot, not from its node.
  for (const std::string model : {"planar", "spatial_bend"}) {
    const bool planar = model == "planar";
    const std::string zero = planar ? "" : ", 0";
    CAPTURE(model);
    const std::string outcome =
        failure("title: t\nmodel: " + model + "\nrods:\n  - {name: rod, nodes: 60, from: [0, 0" +
                zero + "], to: [0.6, 0.8" + zero +
                "], cross_section: {stiffness: {EA: 100, EI: 1, mass_per_length: 1}}}\n"
                "supports:\n  - {rod: rod, at: start, clamp: true}\n"
                "loads:\n  - gravity: [-865, -292" +
                zero + "]\nanalysis: static\n");
    CHECK(outcome.rfind("collapsed: ", 0) == 0);
  }
}

}  // namespace der::test
