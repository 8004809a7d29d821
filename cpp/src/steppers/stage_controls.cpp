#include "der/steppers/stage_controls.hpp"

#include <algorithm>

namespace der {

void StageControls::evaluate(const State& state, double time, Vector& controls) {
  evaluate_controls(model_, state, std::min(time, step_end_), controls);
  if (time <= step_end_) return;
  evaluate_controls(model_, state, state.time, start_);
  const double beyond = (time - step_end_) / (step_end_ - state.time);
  controls += beyond * (controls - start_);
  for (const Index control : model_.tables.without_kinks()) {
    if (find_ramp(state, control) != nullptr) continue;
    controls[control] = value_at(model_.tables[control], time);
  }
  model_.rest_shape.enter(controls);
}

}  // namespace der
