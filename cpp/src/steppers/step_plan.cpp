#include "der/steppers/step_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "der/core/error.hpp"
#include "der/steppers/stable_step.hpp"

namespace der {
namespace {

/// Of the stable step at the start: a rod that is stretched or bent gets stiffer.
constexpr double kMargin = 0.9;
/// Two times closer than this share of the time between frames are one.
constexpr double kSameFrame = 1e-9;

std::int64_t count_steps(double duration, double step) {
  // A duration that is a whole number of steps but for rounding has no short last step.
  return static_cast<std::int64_t>(std::ceil(duration / step * (1.0 - 1e-12)));
}

void refuse_unstable_step(const scenario::Time& time, const StableStep& stable,
                          const Model& model) {
  if (time.allow_unstable || time.step <= stable.step * (1.0 + 1e-9)) return;
  throw Error(
      "unstable_step",
      fmt::format("time.step of {:g} s is above the stable step of {}, {:.3g} s, which {} at "
                  "{} sets. Write 'step: auto' or a step of at most {:.2g} s, take an "
                  "implicit integrator, or say 'allow_unstable: true' to run it all the same",
                  time.step, time.integrator, stable.step, stable.limited_by,
                  describe_dof(model, stable.worst_dof), kMargin * stable.step));
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

StepPlan plan_steps(const scenario::Scene& scene, const Model& model, const StepperInfo& stepper) {
  const scenario::Time& time = scene.time;
  StepPlan plan;
  plan.every = scene.output.every;
  plan.largest_step = std::numeric_limits<double>::infinity();
  if (!scene.is_dynamic()) return plan;

  plan.step = time.step;
  if (!stepper.implicit) {
    const StableStep stable = stable_step(model, model.initial_positions, stepper.drag_limits_step);
    plan.largest_step = kMargin * stable.step;
    if (time.stepping == scenario::Stepping::Fixed) refuse_unstable_step(time, stable, model);
    if (time.stepping == scenario::Stepping::Automatic) {
      plan.step = plan.every / std::ceil(plan.every / plan.largest_step);
    }
  }
  if (plan.step == 0.0) return plan;
  plan.total_steps = count_steps(time.duration, plan.step);
  plan.steps_per_frame = std::max<std::int64_t>(1, std::llround(plan.every / plan.step));
  return plan;
}

}  // namespace der
