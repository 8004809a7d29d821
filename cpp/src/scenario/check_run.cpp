#include <algorithm>
#include <cmath>
#include <string>

#include "der/catalog/steppers.hpp"
#include "scenario/checks.hpp"

namespace der::scenario {
namespace {

/// Ten halvings of a step that fails.
constexpr double kMinimumStepShare = 1.0 / 1024.0;
/// The longest step of adaptive steps for this purpose, as a fraction of the duration. The smallest
/// step is then 1e-12 of the duration, a thousand times its rounding error.
constexpr double kAdaptiveShare = 1e-9;
/// The smallest frame takes 200 bytes: these fill any disk.
constexpr double kMaxFrames = 1e9;
/// Frames of a run where the scene does not say how often to save.
constexpr double kDefaultFrames = 1000.0;

void check_every(SceneText& scene, Diagnostics& diagnostics) {
  const Path path{"output", "every"};
  const Time& time = scene.time;
  const double frame_time = time.duration / kDefaultFrames;
  const auto& given = scene.given_output.given_every;
  scene.output.every = given.value_or(frame_time);
  if (time.duration / scene.output.every > kMaxFrames) {
    diagnostics.add(path, fmt::format("makes more than {:g} frames out of the duration, {} s",
                                      kMaxFrames, time.duration));
    return;
  }
  if (time.stepping != Stepping::Fixed) return;
  if (!given) {
    scene.output.every = time.step * std::max(1.0, std::round(frame_time / time.step));
    return;
  }
  const double steps = *given / time.step;
  constexpr double same = 1e-6;  // of a step
  if (steps < 1.0 - same) {
    diagnostics.add(
        path, fmt::format("must be at least the time step, {} s, got {} s", time.step, *given));
  } else if (std::abs(steps - std::round(steps)) > same) {
    const double nearest = std::ceil(steps - 0.5);  // of two as near the shorter
    const double other = nearest < steps ? nearest + 1.0 : nearest - 1.0;
    diagnostics.add(path,
                    fmt::format("must be a whole multiple of the time step, {} s, but {} s "
                                "is {:.6g} steps: write {:.9g} or {:.9g}",
                                time.step, *given, steps, time.step * nearest, time.step * other));
  }
}

void check_fixed_step(const Time& time, Diagnostics& diagnostics) {
  if (time.step > time.duration) {
    diagnostics.add({"time", "step"},
                    fmt::format("must not be greater than the duration, {} s, got "
                                "{} s",
                                time.duration, time.step));
  }
  if (time.duration / time.step > kMostSteps) {
    diagnostics.add({"time", "step"}, fmt::format("makes more than {:g} steps out of the duration, "
                                                  "{} s",
                                                  kMostSteps, time.duration));
  }
}

/// Checks the keys that only some integrators have.
void check_integrator(const TimeText& given, Time& time, Diagnostics& diagnostics) {
  if (given.given_spectral_radius) {
    time.spectral_radius = *given.given_spectral_radius;
    if (time.integrator != "generalized_alpha") {
      diagnostics.add(
          {"time", "spectral_radius"},
          fmt::format("only generalized_alpha has a spectral radius, not {}", time.integrator));
    }
  }
  const bool implicit = find_stepper(time.integrator).implicit;
  if (time.stepping == Stepping::Automatic && implicit) {
    diagnostics.add(
        {"time", "step"},
        fmt::format("'auto' is the largest stable step of an explicit integrator; {} is "
                    "stable with any: give 'tolerance' in its place, to which steps adapt, or a "
                    "step",
                    time.integrator));
  }
}

}  // namespace

void check_time(CheckContext& context) {
  SceneText& scene = context.scene;
  check_continuation(context);
  if (!scene.is_dynamic() && scene.start_from == "equilibrium") {
    context.diagnostics.add(
        {"start_from"},
        "an analysis looks for the equilibrium itself: name the folder of a run, or "
        "leave the key out");
  }
  Diagnostics& diagnostics = context.diagnostics;
  scene.time = static_cast<const Time&>(scene.given_time);
  scene.output = static_cast<const Output&>(scene.given_output);
  if (!scene.is_dynamic()) return;
  if (diagnostics.under({"time"}) || diagnostics.under({"analysis"})) return;
  const TimeText& given = scene.given_time;
  Time& time = scene.time;
  double longest = time.duration * kAdaptiveShare;  // that the smallest step is a share of
  if (given.given_tolerance) {
    time.stepping = Stepping::Adaptive;
    time.tolerance = *given.given_tolerance;
  } else if (const auto* step = std::get_if<double>(&*given.given_step)) {
    time.step = *step;
    check_fixed_step(time, diagnostics);
    longest = time.step;
  } else {
    time.stepping = Stepping::Automatic;
    longest = 0.0;  // the step is not known yet
  }
  check_integrator(given, time, diagnostics);
  time.minimum_step = given.given_minimum_step.value_or(longest * kMinimumStepShare);
  if (time.stepping == Stepping::Fixed && time.minimum_step > time.step) {
    diagnostics.add({"time", "minimum_step"},
                    fmt::format("must not be greater than the step, {} s, got {} s", time.step,
                                time.minimum_step));
  }
  if (!diagnostics.under({"output", "every"})) check_every(scene, diagnostics);
}

}  // namespace der::scenario
