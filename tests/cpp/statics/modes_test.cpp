// Vibration modes and linear buckling loads.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "der/core/constants.hpp"
#include "der/core/error.hpp"
#include "der/simulation.hpp"
#include "statics/statics_scenes.hpp"

namespace der::test {
namespace {

double product(const Model& model, const Vector& a, const Vector& b) {
  return a.dot(model.mass.momentum(b));
}

}  // namespace

TEST_CASE("modes of a pinned beam: frequencies, order, and shapes of unit modal mass") {
  Simulation simulation(Scenario::parse(straight_rod(41, kPinned + kStatic)));
  simulation.equilibrium();
  const auto modes = simulation.modes(3);
  REQUIRE(modes.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const double k = kPi * static_cast<double>(i + 1);
    CHECK(modes[i].frequency == doctest::Approx(k * k / (2.0 * kPi)).epsilon(1e-3));
    CHECK(modes[i].growth_rate == 0.0);
    for (std::size_t j = 0; j < 3; ++j) {
      const double expected = i == j ? 1.0 : 0.0;
      CHECK(std::abs(product(simulation.model(), modes[i].shape, modes[j].shape) - expected) <
            1e-7);
    }
    for (const HeldDof& held : simulation.model().held) CHECK(modes[i].shape[held.dof] == 0.0);
  }
}

TEST_CASE("more modes than degrees of freedom are all there are") {
  Simulation simulation(Scenario::parse(straight_rod(3, kPinned + kStatic)));
  simulation.equilibrium();
  CHECK(simulation.modes(100).size() == 3);
}

TEST_CASE("rods from nanometres to kilometres have their modes") {
  for (const double length : {1e-8, 1e-4, 1.0, 1e3}) {
    // Density 2000 kg/m^3, modulus 1e11 Pa, square of length/50: f1 is pi/2 sqrt(EI/mu) / L^2.
    const double side = length / 50.0;
    const double EI = 1e11 * std::pow(side, 4) / 12.0;
    const double mu = 2000.0 * side * side;
    Simulation simulation(Scenario::parse(fmt::format(
        "title: t\nrods:\n  - {{name: rod, nodes: 35, from: [0, 0], to: [{}, 0], cross_section: "
        "{{stiffness: {{EA: {}, EI: {}, mass_per_length: {}}}}}}}\n"
        "supports:\n  - {{rod: rod, at: start, fix: [x, \"y\"]}}\n"
        "  - {{rod: rod, at: end, fix: [\"y\"]}}\nanalysis: {{modes: {{count: 4}}}}\n",
        length, 1e11 * side * side, EI, mu)));
    simulation.equilibrium();
    const auto modes = simulation.modes(4);
    REQUIRE(modes.size() == 4);
    const double first = 0.5 * kPi * std::sqrt(EI / mu) / (length * length);
    for (std::size_t i = 0; i < 3; ++i) {
      CAPTURE(length);
      const auto number = static_cast<double>(i + 1);
      // Off by order 2 or more in the element length, (i pi / 34)^2 / 12 at the most.
      CHECK(std::abs(modes[i].frequency / (first * number * number) - 1.0) < 2e-3);
    }
  }
}

TEST_CASE("an unstable equilibrium grows, one out of balance has no modes") {
  const std::string loads = "loads:\n  - point_force: {rod: rod, at: end, force: [-15, 0]}\n";
  Simulation simulation(Scenario::parse(straight_rod(41, kPinned + loads + kStatic)));
  CHECK_THROWS_WITH_AS((void)simulation.modes(1),
                       doctest::Contains("are not in balance here: call equilibrium() first"),
                       Error);
  simulation.equilibrium(false);
  const auto modes = simulation.modes(2);
  // w^2 = k^2 (k^2 - P)
  CHECK(modes[0].frequency == 0.0);
  CHECK(modes[0].growth_rate == doctest::Approx(kPi * std::sqrt(15.0 - kPi * kPi)).epsilon(1e-3));
  CHECK(modes[1].growth_rate == 0.0);
  CHECK(modes[1].frequency > 0.0);
}

TEST_CASE("a rod that nothing holds has three rigid motions") {
  Simulation simulation(Scenario::parse(straight_rod(21, kStatic)));
  CHECK(simulation.equilibrium().stability.neutral_directions == 3);
  const auto modes = simulation.modes(4);
  for (std::size_t i = 0; i < 3; ++i) CHECK(modes[i].frequency == 0.0);
  CHECK(modes[3].frequency == doctest::Approx(4.73004 * 4.73004 / (2.0 * kPi)).epsilon(1e-3));
}

TEST_CASE("buckling loads of a column, and shapes whose largest displacement is 1") {
  Simulation simulation(Scenario::parse(straight_rod(41, kPinned + kPush + kBuckling)));
  const Vector before = simulation.gradient();
  const LinearBuckling buckling = simulation.buckling(3);
  const auto& modes = buckling.modes;
  REQUIRE(modes.size() == 3);
  CHECK(buckling.rotation == 0.0);
  CHECK(buckling.strain == doctest::Approx(1e-6));
  for (std::size_t i = 0; i < 3; ++i) {
    // The exact factor of the chain.
    const double k = 80.0 * std::sin(kPi * static_cast<double>(i + 1) / 80.0);
    CHECK(modes[i].load_factor == doctest::Approx(k * k).epsilon(1e-8));
    CHECK(modes[i].shape.lpNorm<Eigen::Infinity>() == doctest::Approx(1.0));
  }
  // The shape is that without loads, the loads are those of the scene.
  CHECK((simulation.gradient() - before).norm() < 1e-9);
}

TEST_CASE("what never buckles has no buckling loads, what nothing holds is refused") {
  const std::string pull = "loads:\n  - point_force: {rod: rod, at: end, force: [1, 0]}\n";
  const LinearBuckling pulled =
      Simulation(Scenario::parse(straight_rod(11, kPinned + pull + kBuckling))).buckling(2);
  CHECK(pulled.modes.empty());
  CHECK(pulled.rotation == 0.0);
  Simulation loose(Scenario::parse(straight_rod(11, kPush + kBuckling)));
  const Vector before = loose.gradient();
  CHECK_THROWS_AS(loose.buckling(1), NotConvergedError);
  CHECK(loose.gradient() == before);
}

TEST_CASE("loads across a rod press nothing: no buckling loads, but a rotation") {
  const std::string across = "loads:\n  - point_force: {rod: rod, at: end, force: [0, -1]}\n";
  const std::string clamp = "supports:\n  - {rod: rod, at: start, clamp: true}\n";
  Simulation simulation(Scenario::parse(straight_rod(41, clamp + across + kBuckling)));
  const LinearBuckling bent = simulation.buckling(2);
  CHECK(bent.modes.empty());
  CHECK(bent.rotation == doctest::Approx(0.5).epsilon(1e-3));  // P L^2 / 2 EI
}

TEST_CASE("the size of the loads does not matter to their buckling") {
  for (const std::string force : {"1e-25", "1e-6", "1e16"}) {
    const std::string push =
        "loads:\n  - point_force: {rod: rod, at: end, force: [-" + force + ", 0]}\n";
    Simulation simulation(Scenario::parse(straight_rod(11, kPinned + push + kBuckling)));
    const auto modes = simulation.buckling(9).modes;
    REQUIRE(modes.size() == 9);
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const double k = 20.0 * std::sin(kPi * static_cast<double>(i + 1) / 20.0);
      CHECK(modes[i].load_factor * std::stod(force) == doctest::Approx(k * k).epsilon(1e-9));
    }
  }
}

TEST_CASE("all modes of many degrees of freedom are orthogonal and in order") {
  Simulation simulation(Scenario::parse(straight_rod(41, kPinned + kStatic)));
  simulation.equilibrium();
  const Index size = simulation.model().num_free();
  const auto modes = simulation.modes(size);
  REQUIRE(modes.size() == static_cast<std::size_t>(size));
  double worst = 0.0;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (i > 0) CHECK(modes[i].frequency > modes[i - 1].frequency);
    for (std::size_t j = 0; j < i; ++j) {
      worst =
          std::max(worst, std::abs(product(simulation.model(), modes[i].shape, modes[j].shape)));
    }
  }
  CHECK(worst < 1e-7);
}

}  // namespace der::test
