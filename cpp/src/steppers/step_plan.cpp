#include "der/steppers/step_plan.hpp"

#include <algorithm>
#include <cmath>

#include "der/steppers/stable_step.hpp"

namespace der {
namespace {

/// Two times closer than this share of the time between frames are one.
constexpr double kSameFrame = 1e-9;

/// Frames that an adaptive step may hold: a run can be interrupted, and its frames are counted,
/// between steps alone.
constexpr double kFramesOfAStep = 10'000.0;

std::int64_t count_steps(double duration, double step) {
  // A duration that is a whole number of steps but for rounding has no short last step.
  return static_cast<std::int64_t>(std::ceil(duration / step * (1.0 - 1e-12)));
}

}  // namespace

bool StepPlan::is_frame(std::int64_t steps_done, double time) const {
  if (step > 0.0 || every == 0.0) return steps_done % steps_per_frame == 0;
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
