// Newmark's average acceleration on a bar that vibrates along its axis.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "der/simulation.hpp"

namespace der::test {
namespace {

// One edge, held at its left end. Along its axis it is a linear spring, EA/l, however far it is
// stretched, with half of its mass on the free node: an oscillator of frequency sqrt(2 EA/mu)/l.
constexpr double kStiffness = 50.0;                                      // EA [N]
constexpr double kMassPerLength = 4.0;                                   // mu [kg/m]
const double kFrequency = std::sqrt(2.0 * kStiffness / kMassPerLength);  // 5 rad/s; l is 1 m
constexpr int kSteps = 1000;

/// [m] So small that the solver's tolerance, relative to it, is below the rounding of a coordinate.
constexpr double kAmplitude = 1e-6;

/// In steps such that w dt is `fast`.
Simulation oscillator(const char* integrator, double fast) {
  const double step = fast / kFrequency;
  return Simulation(Scenario::parse(fmt::format(R"(
title: Oscillator
rods:
  - name: bar
    points: [[0, 0], [1, 0]]
    cross_section: {{stiffness: {{EA: {}, EI: 1, mass_per_length: {}}}}}
    initial_velocity: [[0, 0], [{}, 0]]
supports:
  - {{rod: bar, at: start, fix: [x, y]}}
time: {{duration: {}, step: {}, integrator: {}}}
solver: {{residual_tolerance: 1e-13, step_tolerance: 1e-13}}
)",
                                                kStiffness, kMassPerLength, kFrequency * kAmplitude,
                                                kSteps * step, step, integrator),
                                    "oscillator"));
}

/// Displacement, and velocity over the frequency, of the free node [m].
Vec2 phase(const Simulation& simulation) {
  const State& state = simulation.state();
  return {state.positions[2] - 1.0, state.velocities[2] / kFrequency};
}

}  // namespace

TEST_CASE("newmark turns every linear vibration by 2 atan(w dt/2) a step and damps none") {
  // The trapezoidal rule multiplies v/w + i x by (1 + i w dt/2)/(1 - i w dt/2), which has that
  // angle and the modulus 1 (Hughes, The Finite Element Method, section 9.1): the frequency is
  // (2/dt) atan(w dt/2), and the amplitude stays. The last two are far too fast for the step.
  for (const double fast : {0.01, 0.3, 2.0, 50.0, 1000.0}) {
    CAPTURE(fast);
    Simulation simulation = oscillator("newmark", fast);
    const double angle = 2.0 * std::atan(0.5 * fast);
    double off = 0.0;
    for (int n = 1; n <= kSteps; ++n) {
      simulation.step();
      const Vec2 exact{kAmplitude * std::sin(n * angle), kAmplitude * std::cos(n * angle)};
      off = std::max(off, (phase(simulation) - exact).norm());
    }
    // Each step rounds a coordinate of about 1 m, by 1.1e-16 m at most.
    CHECK(off < 1.1e-16 * kSteps);
    CHECK(off < 1e-5 * kAmplitude);
  }
}

TEST_CASE("generalized_alpha, of the same family, damps what is too fast for the step") {
  // Its spectral radius at infinite frequency is 0.9 unless given, and a double root of the method
  // (Chung and Hulbert 1993): after n steps the amplitude goes with n 0.9^n.
  Simulation simulation = oscillator("generalized_alpha", 1000.0);
  constexpr int kHalf = 40;
  const auto amplitude_after = [&](int steps) {
    for (int n = 0; n < steps; ++n) simulation.step();
    return phase(simulation).norm();
  };
  const double before = amplitude_after(kHalf);
  const double ratio = amplitude_after(kHalf) / before;
  CHECK(std::pow(ratio / 2.0, 1.0 / kHalf) == doctest::Approx(0.9).epsilon(0.01));
}

}  // namespace der::test
