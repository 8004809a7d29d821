#pragma once

#include <string>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/steppers/stable_step.hpp"
#include "der/steppers/stepper.hpp"

namespace der {

namespace scenario {
struct Time;
}

/// Keeps the steps of an explicit run stable: compressed edges, and with the
/// tangent measure bent ones, make a rod stiffer than it was at the start.
class StabilityMonitor {
 public:
  StabilityMonitor(const Model& model, const StepperInfo& stepper, const scenario::Time& time);

  /// Stable step [s] at a state.
  double stable_step(const State& state);
  /// Throws Error ("unstable_step") if the scene's own step, or its smallest one, is too long for
  /// `state`, the start of a run, unless the scene allows it.
  void check_start(const State& state);
  /// To be called before each piece of a step of length `step` [s]. Evaluates the stable step
  /// whenever the shape has changed since the last time (in `state.memory`), and sets
  /// `state.next_step` to the length of the pieces that the step has to be done in. `step: auto`
  /// keeps them stable, and short against the change of shape. Throws DivergedError where the
  /// scene's own step is no longer stable, unless the scene allows it, and where a stable one would
  /// be shorter than time.minimum_step, or 1e-5 of `step` where that is not given.
  void look(State& state, double step);
  /// Why a motion that started at `start` and got to `last` has blown up in the next piece of
  /// `step` [s], and what to try.
  std::string explain_blow_up(const State& start, const State& last, double step);

 private:
  StableStep explain(const State& state);
  std::string explain_overrun(const State& state);
  std::string explain_end(const State& state, double least);

  const Model& model_;
  const scenario::Time& time_;
  StableStepBound bound_;
  Configuration here_;
};

}  // namespace der
