// Rods that pass through themselves or one another: where and when the recorder sees it, in free
// falls whose instants are known, and what it leaves out.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>

#include "der/output/recorder.hpp"
#include "der/output/run.hpp"
#include "der/output/summary.hpp"
#include "der/scenario/reader.hpp"
#include "der/simulation.hpp"

namespace der {
namespace {

using Crossing = std::optional<CrossingMonitor::Crossing>;

struct Run {
  explicit Run(const std::string& scene) : simulation(Scenario::parse(scene, "crossing")) {
    Recorder recorder(simulation);
    outcome = run(simulation, recorder);
    REQUIRE(outcome.ok());
  }
  Simulation simulation;
  RunOutcome outcome;
};

Crossing crossing_of(const std::string& scene) { return Run(scene).outcome.crossing; }

constexpr double kGravity = 10.0;  // [m/s^2]
constexpr double kGap = 0.2;       // [m] between the axes
constexpr double kRadius = 0.01;   // [m]

std::string rod(const std::string& name, const std::string& shape, const std::string& radius) {
  return fmt::format(
      "  - {{name: {}, {}, cross_section: {{circle: {{radius: {}}}}}, material: {{youngs_modulus: "
      "1e7, poissons_ratio: 0.5, density: 1000}}}}\n",
      name, shape, radius);
}
std::string held(const std::string& name) {
  return fmt::format("{{rod: {0}, at: start, clamp: true}}, {{rod: {0}, at: end, clamp: true}}",
                     name);
}
std::string run_of(const std::string& rods, const std::string& supports, const std::string& gravity,
                   const std::string& time = "{duration: 0.5, step: 0.0005}") {
  return "rods:\n" + rods + "supports: [" + supports + "]\nloads: [{gravity: " + gravity +
         "}]\ntime: " + time + "\n";
}

/// One rod falls onto another: its own axis along `along`, above the middle of it.
std::string fall(int dimension, const std::string& time = "{duration: 0.5, step: 0.0005}") {
  if (dimension == 2) {
    return run_of(rod("low", "nodes: 11, from: [0, 0], to: [1, 0]", "0.01") +
                      rod("high", "nodes: 4, from: [0.72, 0.2], to: [0.72, 0.5]", "0.01"),
                  held("low"), "[0, -10]", time);
  }
  return run_of(rod("low", "nodes: 11, from: [0, 0, 0], to: [1, 0, 0]", "0.01") +
                    rod("high", "nodes: 11, from: [0.72, -0.3, 0.2], to: [0.72, 0.7, 0.2]", "0.01"),
                held("low"), "[0, 0, -10]", time);
}

TEST_CASE("crossing: a rod that falls through another is seen when and where it gets there") {
  for (const int dimension : {2, 3}) {
    CAPTURE(dimension);
    const Run run(fall(dimension));
    REQUIRE(run.outcome.crossing);
    const CrossingMonitor::Crossing& found = *run.outcome.crossing;
    CHECK(found.first_rod == "low");
    CHECK(found.second_rod == "high");
    // The held rod sags meanwhile, by a thousandth of that.
    const double due = std::sqrt(2.0 * (kGap - 2.0 * kRadius) / kGravity);
    CHECK(found.time > due);
    CHECK(found.time < due + 0.02);
    CHECK(found.first_place == doctest::Approx(0.72).epsilon(0.01));
    CHECK(found.second_place == doctest::Approx(dimension == 2 ? 0.0 : 0.3).epsilon(0.05));
    const auto told = warnings(run.simulation, run.outcome);
    REQUIRE(told.size() == 1);
    CHECK(told[0].find("rods 'low' and 'high' pass through one another at t = 0.") == 0);
  }
}

TEST_CASE("crossing: it is seen with explicit and with adaptive steps, too") {
  CHECK(crossing_of(fall(3, "{duration: 0.5, step: auto, integrator: verlet}")));
  CHECK(crossing_of(fall(3, "{duration: 0.5, tolerance: 1e-4}")));
}

TEST_CASE("crossing: a rod in the plane that is driven across itself is seen") {
  // Its ends turn toward each other and past, in a loop of the elastica.
  const std::string loop = run_of(
      rod("arch", "nodes: 41, from: [0, 0], to: [1, 0]", "0.005"),
      "{rod: arch, at: start, clamp: true}, {rod: arch, at: end, clamp: true, prescribe: {angle: "
      "{times: [0, 1], values: [0, 6.283]}, x: {times: [0, 1], values: [0, -0.9]}}}",
      "[0, 0]", "{duration: 1.2, step: 0.002, integrator: bdf2}");
  const Crossing found = crossing_of(loop);
  REQUIRE(found);
  CHECK(found->first_rod == found->second_rod);
  CHECK(found->first_place < found->second_place);
}

TEST_CASE("crossing: what overlaps or touches from the start is left out, and so are near misses") {
  const std::string free_fall = "[0, 0, -10]";
  const std::string bundle = rod("a", "nodes: 11, from: [0, 0, 0], to: [1, 0, 0]", "0.01") +
                             rod("b", "nodes: 11, from: [0, 0.015, 0], to: [1, 0.015, 0]", "0.01");
  CHECK_FALSE(crossing_of(run_of(bundle, held("a"), free_fall)));
  const std::string touching = rod("a", "nodes: 11, from: [0, 0, 0], to: [1, 0, 0]", "0.01") +
                               rod("b", "nodes: 11, from: [1, 0, 0], to: [1, 1, 0]", "0.01");
  CHECK_FALSE(crossing_of(run_of(touching, held("a"), free_fall)));
  // One radius further aside, the falling rod misses the end of the other.
  const std::string miss =
      rod("low", "nodes: 11, from: [0, 0, 0], to: [1, 0, 0]", "0.01") +
      rod("high", "nodes: 11, from: [1.03, -0.3, 0.2], to: [1.03, 0.7, 0.2]", "0.01");
  CHECK_FALSE(crossing_of(run_of(miss, held("low"), free_fall)));
  // A thick rod on a fine mesh, bent about as far as a rod can be.
  const std::string fine =
      run_of(rod("thick", "nodes: 201, from: [0, 0], to: [1, 0]", "0.05"),
             "{rod: thick, at: start, clamp: true}, {rod: thick, at: end, clamp: true, prescribe: "
             "{angle: {times: [0, 1], values: [0, 3]}}}",
             "[0, 0]", "{duration: 1, step: 0.01, integrator: bdf2}");
  CHECK_FALSE(crossing_of(fine));
}

TEST_CASE("crossing: an equilibrium that lies across itself says so without a time") {
  // It curls up by a turn and a quarter.
  const std::string wound =
      "rods:\n" +
      rod("strip", "nodes: 61, natural_curvature: 8, from: [0, 0], to: [1, 0]", "0.005") +
      "supports: [{rod: strip, at: start, clamp: true}]\nanalysis: static\n";
  const Run run(wound);
  REQUIRE(run.outcome.crossing);
  const auto told = warnings(run.simulation, run.outcome);
  REQUIRE_FALSE(told.empty());
  CHECK(told.back().find("passes through itself in the equilibrium") != std::string::npos);
  // Exactly one turn: its ends meet.
  CHECK_FALSE(crossing_of("rods:\n" +
                          rod("ring",
                              "nodes: 61, natural_curvature: 6.283185307, from: [0, 0], "
                              "to: [1, 0]",
                              "0.01") +
                          "supports: [{rod: ring, at: start, clamp: true}]\nanalysis: static\n"));
}

}  // namespace
}  // namespace der
