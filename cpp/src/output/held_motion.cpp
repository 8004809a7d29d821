#include "output/held_motion.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/scenario/scenario.hpp"

namespace der {

HeldMotion::HeldMotion(const scenario::Scene& scene)
    : duration_(scene.is_dynamic() ? scene.time.duration : 0.0) {}

void HeldMotion::evaluate(const Model& model, const State& state) {
  step_ = state.last_step;
  moves_ = duration_ > 0.0 && step_ > 0.0 &&
           std::any_of(model.held.begin(), model.held.end(),
                       [](const HeldDof& held) { return held.displacement >= 0; });
  if (!moves_) return;
  constexpr double kRounding = 1e-9;
  at_end_ = state.time + step_ > duration_ * (1.0 + kRounding) && state.time >= 3.0 * step_;
  for (std::size_t i = 0; i < controls_.size(); ++i) {
    const double steps = static_cast<double>(i) - (at_end_ ? 0.0 : 1.0);
    evaluate_controls(model, state, state.time - steps * step_, controls_[i]);
  }
}

HeldMotion::Rates HeldMotion::of(const HeldDof& held, const State& state) const {
  const Rates even{state.velocities[held.dof], 0.0};
  if (!moves_ || held.displacement < 0) return even;
  const bool set_by_program =
      std::any_of(state.ramps.begin(), state.ramps.end(),
                  [&](const Ramp& ramp) { return ramp.control == held.displacement; });
  if (set_by_program) return even;
  const auto at = [&](std::size_t i) { return controls_[i][held.displacement]; };
  if (at_end_) {
    return {(1.5 * at(0) - 2.0 * at(1) + 0.5 * at(2)) / step_,
            (2.0 * at(0) - 5.0 * at(1) + 4.0 * at(2) - at(3)) / (step_ * step_)};
  }
  return {0.5 * (at(0) - at(2)) / step_, (at(0) - 2.0 * at(1) + at(2)) / (step_ * step_)};
}

}  // namespace der
