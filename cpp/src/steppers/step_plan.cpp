#include "der/steppers/step_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "der/core/error.hpp"
#include "der/scenario/scenario.hpp"
#include "der/steppers/stable_step.hpp"

namespace der {
namespace {

/// Times closer than this fraction of the time between frames, or of a step, are equal.
constexpr double kSameFrame = 1e-9;

/// Frames that an adaptive step may hold: a run can be interrupted, and its frames are counted,
/// between steps alone.
constexpr double kFramesOfAStep = 10'000.0;

/// The rounding error of a time that is counted in steps, in steps.
double rounding(double steps) {
  return std::max(kSameFrame, 4.0 * std::numeric_limits<double>::epsilon() * steps);
}

void check_count(double duration, double step) {
  if (duration / step <= scenario::kMostSteps) return;
  throw Error("too_many_steps",
              fmt::format("a stable step of {:.3g} s makes more than {:g} steps out of the "
                          "duration, {:g} s: take an implicit integrator, a shorter duration, or a "
                          "rod that is less stiff for its mass",
                          step, scenario::kMostSteps, duration));
}

std::int64_t count_steps(double duration, double step) {
  // A duration that is a whole number of steps but for rounding has no short last step.
  return static_cast<std::int64_t>(std::ceil(duration / step * (1.0 - 1e-12)));
}

}  // namespace

double StepPlan::next_time(double time) const {
  const double count = time / step;
  if (rounding(count) > 0.5) return time;
  const double done = std::floor(count + rounding(count));
  double next = (done + 1.0) * step;
  if (done + 1.0 == static_cast<double>(total_steps)) next = duration;
  // The last step may be short: from its end on the whole ones are counted again.
  return next > time ? next : (done + 2.0) * step;
}

bool StepPlan::is_frame(double time) const {
  if (every == 0.0) return true;
  if (step > 0.0) {
    const double count = time / step;
    const double steps = std::round(count);
    return std::abs(count - steps) <= rounding(count) &&
           std::fmod(steps, static_cast<double>(steps_per_frame)) == 0.0;
  }
  const double frames = time / every;
  return std::abs(frames - std::round(frames)) < kSameFrame;
}

std::pair<std::int64_t, std::int64_t> StepPlan::frames_between(double from, double to) const {
  return {static_cast<std::int64_t>(std::floor(from / every + kSameFrame)) + 1,
          static_cast<std::int64_t>(std::ceil(to / every - kSameFrame)) - 1};
}

StepPlan plan_steps(const scenario::Scene& scene, double stable_step) {
  const scenario::Time& time = scene.time;
  StepPlan plan;
  plan.every = scene.output.every;
  plan.largest_step = kStepMargin * stable_step;
  if (!scene.is_dynamic()) return plan;

  plan.duration = time.duration;
  if (time.stepping != scenario::Stepping::Fixed) check_count(time.duration, plan.largest_step);
  if (time.stepping == scenario::Stepping::Adaptive) {
    const double longest = std::max(kFramesOfAStep * plan.every, time.minimum_step);
    plan.largest_step = std::min(plan.largest_step, longest);
  }
  plan.step = time.step;
  if (time.stepping == scenario::Stepping::Automatic) {
    plan.step = plan.every / std::max(1.0, std::ceil(plan.every / plan.largest_step));
  }
  if (plan.step == 0.0) return plan;
  plan.total_steps = count_steps(time.duration, plan.step);
  plan.steps_per_frame = std::max<std::int64_t>(1, std::llround(plan.every / plan.step));
  return plan;
}

}  // namespace der
