// Static equilibria: found, judged, or refused with a reason.
#include <doctest/doctest.h>

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
    return Simulation(Scenario::parse(scene(kClamp, force))).equilibrium().negative_pivots;
  };
  CHECK(unstable("[-2.4, 0]") == 0);
  CHECK(unstable("[-2.6, 0]") == 1);
  CHECK(unstable("[-22.6, 0]") == 2);
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
  CHECK(simulation.equilibrium().negative_pivots == 0);
  const Vector& x = simulation.state().positions;
  CHECK(x[x.size() - 2] == doctest::Approx(0.0).epsilon(1e-6));
  // Hooke's law: 3 N stretch the metre by 3 / EA.
  CHECK(x[x.size() - 1] == doctest::Approx(-(1.0 + 3.0 / 1e5)).epsilon(1e-9));
}

}  // namespace der::test
