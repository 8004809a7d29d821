#include "output/held_motion.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/index.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/scenario/scenario.hpp"
#include "der/supports/clamp.hpp"

namespace der {

HeldMotion::HeldMotion(const scenario::Scene& scene)
    : duration_(scene.is_dynamic() ? scene.time.duration : 0.0) {}

void HeldMotion::evaluate(const Model& model, const State& state) {
  step_ = state.last_step;
  moves_ = duration_ > 0.0 && step_ > 0.0 &&
           (any_clamp_turns(model) ||
            std::any_of(model.held.begin(), model.held.end(),
                        [](const HeldDof& held) { return held.displacement >= 0; }));
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
  if (held.displacement < 0) return even;
  const auto rates = of_control(held.displacement, state);
  if (!rates) return even;
  return {held.weight * rates->velocity, held.weight * rates->acceleration};
}

double HeldMotion::turning_rate(Index control, const Model& model, const State& state) const {
  if (const auto rates = of_control(control, state)) return rates->velocity;
  const Ramp* ramp = find_ramp(state, control);
  const bool moved = ramp != nullptr && step_ > 0.0;
  const double mean = moved ? (ramp->at(state.time) - ramp->at(state.time - step_)) / step_ : 0.0;
  return control_rate(model, state, control, state.time, mean);
}

std::optional<HeldMotion::Rates> HeldMotion::of_control(Index control, const State& state) const {
  if (!moves_) return std::nullopt;
  if (const Ramp* ramp = find_ramp(state, control)) {
    if (!knows_past(*ramp, state)) return std::nullopt;
    return after_steps([&](int i) { return ramp->past(state.time - i * step_); });
  }
  const auto at = [&](int i) { return controls_[to_size(i)][control]; };
  if (at_end_) return after_steps(at);
  return Rates{0.5 * (at(0) - at(2)) / step_, (at(0) - 2.0 * at(1) + at(2)) / (step_ * step_)};
}

template <class At>
HeldMotion::Rates HeldMotion::after_steps(const At& at) const {
  return {(1.5 * at(0) - 2.0 * at(1) + 0.5 * at(2)) / step_,
          (2.0 * at(0) - 5.0 * at(1) + 4.0 * at(2) - at(3)) / (step_ * step_)};
}

bool HeldMotion::knows_past(const Ramp& ramp, const State& state) const {
  constexpr double kSameLength = 1e-6;
  const double first = state.time - 3.0 * step_;
  if (first < -kSameLength * step_) return false;
  const bool is_straight = first >= ramp.start;
  return is_straight || std::abs(ramp.step - step_) <= kSameLength * step_;
}

}  // namespace der
