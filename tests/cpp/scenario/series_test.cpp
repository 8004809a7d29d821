// Values that follow time: tables, smooth tables and sines, and how far supports move by them.
#include "der/scenario/series.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "der/core/constants.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"
#include "der/steppers/support_motion.hpp"

namespace der::test {
namespace {

using scenario::Course;
using scenario::Series;

const Series kSmooth{{1.0, 3.0, 4.0}, {2.0, -1.0, 5.0}, {Course::Kind::Smooth}};
const Series kSine{{}, {0.5, 2.0}, {Course::Kind::Sine, 0.8, 0.3}};

Scenario moved(const std::string& motion) {
  return Scenario::parse(R"(
rods:
  - name: rod
    points: [[0, 0], [0.5, 0], [1, 0]]
    cross_section: {stiffness: {EA: 1, EI: 1, mass_per_length: 1}}
supports:
  - {rod: rod, at: start, fix: [y], prescribe: {x: )" +
                         motion + R"(}}
start_from: equilibrium
time: {duration: 10, step: 0.01}
)");
}

/// The path [m] of the support up to a time after `start`, over many small steps.
double path(const Series& motion, double start, double end) {
  constexpr int pieces = 20000;
  double sum = 0.0;
  for (int i = 0; i < pieces; ++i) {
    const double a = start + (end - start) * i / pieces;
    const double b = start + (end - start) * (i + 1) / pieces;
    sum += std::abs(value_at(motion, b) - value_at(motion, a));
  }
  return sum;
}

}  // namespace

TEST_CASE("series: a smooth table has no slope and no curvature at its entries") {
  CHECK(value_at(kSmooth, 0.0) == 2.0);
  CHECK(value_at(kSmooth, 9.0) == 5.0);
  CHECK(value_at(kSmooth, 2.0) == doctest::Approx(0.5).epsilon(1e-15));  // half of the way
  CHECK(value_at(kSmooth, 1.5) ==
        doctest::Approx(2.0 - 3.0 * (10.0 / 64 - 15.0 / 256 + 6.0 / 1024)).epsilon(1e-15));
  constexpr double h = 1e-3;
  for (const double entry : kSmooth.times) {
    const double here = value_at(kSmooth, entry);
    for (const double side : {-h, h}) {
      CHECK(std::abs(value_at(kSmooth, entry + side) - here) < 61.0 * h * h * h);
    }
  }
}

TEST_CASE("series: a sine goes on at all times, and is zero as its numbers are") {
  CHECK(value_at(kSine, 0.0) == doctest::Approx(0.5 + 2.0 * std::sin(0.3)).epsilon(1e-15));
  CHECK(value_at(kSine, -1.0) ==
        doctest::Approx(0.5 + 2.0 * std::sin(0.3 - 1.6 * kPi)).epsilon(1e-14));
  CHECK(value_at(kSine, 1.25) == doctest::Approx(value_at(kSine, 0.0)).epsilon(1e-14));
  CHECK(!kSine.constant());
  Series zero = kSine;
  set_to_zero(zero);
  CHECK(is_zero(zero));
  CHECK(value_at(zero, 0.7) == 0.0);
}

TEST_CASE("series: how far a support moves by a smooth table and by a sine") {
  // The shortest edge is 0.5 m: the support moves by `strips` of it.
  const std::string table = "{times: [0, 2, 3], values: [0, 3, 1], smooth: true}";
  const std::string sine = "{sine: {amplitude: 0.7, frequency: 0.8, phase: -0.4, offset: 0.2}}";
  for (const std::string& motion : {table, sine}) {
    CAPTURE(motion);
    const Scenario scenario = moved(motion);
    const Simulation simulation(scenario);
    const SupportMotion support(simulation.model());
    const Series& series = scenario.scene().supports[0].prescribe[0].displacement;
    State state = simulation.state();
    for (const double time : {0.0, 0.7, 1.9, 2.3}) {
      state.time = time;
      for (const double strips : {0.1, 1.0}) {
        const double took = support.time_of(strips, state);
        CAPTURE(time);
        CAPTURE(strips);
        CHECK(path(series, time, time + took) == doctest::Approx(0.5 * strips).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE("series: the models of a scene see sines") {
  const auto chosen = [](const std::string& load) {
    const Scenario scenario = Scenario::parse(R"(
rods:
  - name: rod
    points: [[0, 0, 0], [0.5, 0, 0], [1, 0, 0]]
    cross_section: {stiffness: {EA: 1, EI: 1, mass_per_length: 1}}
supports:
  - {rod: rod, at: start, clamp: tangent}
loads: [)" + load + R"(]
time: {duration: 1, step: 0.01}
)");
    return Simulation(scenario).model().name;
  };
  CHECK(chosen("{gravity: {sine: {amplitude: [0, 1, 0], frequency: 1}}}") == "planar");
  CHECK(chosen("{gravity: {sine: {amplitude: [0, 1, 1], frequency: 1}}}") == "spatial_bend");
  CHECK(chosen("{gravity: {sine: {amplitude: [0, 1, 0], frequency: 1, offset: [0, 0, 1]}}}") ==
        "spatial_bend");
  CHECK(chosen("{moment: {rod: rod, at: end, moment: {sine: {amplitude: [0, 0, 1], frequency: "
               "1}}}}") == "planar");
}

}  // namespace der::test
