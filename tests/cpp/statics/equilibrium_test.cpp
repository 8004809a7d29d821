// Static equilibria: found, judged, or refused with a reason.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

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
  const auto failure = [](const std::string& text) {
    try {
      Simulation(Scenario::parse(text)).equilibrium();
    } catch (const NotConvergedError& error) {
      return error.status() + ": " + error.what();
    }
    return std::string("an equilibrium was found");
  };
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

}  // namespace der::test
