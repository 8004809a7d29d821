#include "der/steppers/stage_controls.hpp"

#include <algorithm>

#include "der/model/prescribed_motion.hpp"

namespace der {

StageControls::StageControls(const Model& model)
    : model_(model),
      start_(Vector::Zero(model.tables.size())),
      end_(Vector::Zero(model.tables.size())) {
  for (const PrescribedControl& each : model.prescribed) {
    const auto is_same = [&](const Motion& other) { return other.control == each.control; };
    if (std::any_of(motions_.begin(), motions_.end(), is_same)) continue;
    motions_.push_back({each.control});
  }
}

/// Sets the rates of all stages to the mean over the step.
void StageControls::find_means(const State& state, double dt) {
  step_end_ = state.time + dt;
  stage_ = -1;
  if (motions_.empty()) return;
  evaluate_controls(model_, state, state.time, start_);
  evaluate_controls(model_, state, step_end_, end_);
  for (Motion& motion : motions_) {
    motion.start = start_[motion.control];
    motion.rate.fill((end_[motion.control] - motion.start) / dt);
  }
}

void StageControls::begin_step(const State& state, double dt) {
  tableau_ = nullptr;
  find_means(state, dt);
}

void StageControls::begin_step(const State& state, double dt, const Tableau& tableau) {
  tableau_ = &tableau;
  find_means(state, dt);
  for (Motion& motion : motions_) {
    const double mean = motion.rate[0];
    double excess = -mean;
    for (Index i = 0; i < tableau.stages; ++i) {
      double& rate = motion.rate[to_size(i)];
      const double time = state.time + tableau.time(i) * dt;
      rate = control_rate(model_, state, motion.control, time, mean);
      excess += tableau.weights[to_size(i)] * rate;
    }
    // So that the step ends where the tables have the support.
    for (Index i = 0; i < tableau.stages; ++i) motion.rate[to_size(i)] -= excess;
  }
}

void StageControls::evaluate(const State& state, double time, Vector& controls) {
  evaluate_controls(model_, state, std::min(time, step_end_), controls);
  if (time > step_end_) {
    evaluate_controls(model_, state, state.time, start_);
    const double beyond = (time - step_end_) / (step_end_ - state.time);
    controls += beyond * (controls - start_);
    for (const Index control : model_.tables.without_kinks()) {
      if (find_ramp(state, control) != nullptr) continue;
      controls[control] = value_at(model_.tables[control], time);
    }
    model_.rest_shape.enter(controls);
  }
  if (stage_ >= 0) move(state, time, controls);
}

/// Puts the supports where the stage has them.
void StageControls::move(const State& state, double time, Vector& controls) const {
  const bool is_result = tableau_ == nullptr
                             ? time == step_end_
                             : tableau_->stiffly_accurate() && stage_ == tableau_->stages - 1;
  if (is_result) return;
  const double dt = step_end_ - state.time;
  for (const Motion& motion : motions_) {
    double share_of_rates = 0.0;
    if (tableau_ == nullptr) {
      share_of_rates = (time - state.time) / dt * motion.rate[0];
    } else {
      for (Index j = 0; j < stage_; ++j) {
        share_of_rates += tableau_->below[to_size(stage_)][to_size(j)] * motion.rate[to_size(j)];
      }
      share_of_rates += tableau_->diagonal * motion.rate[to_size(stage_)];
    }
    controls[motion.control] = motion.start + dt * share_of_rates;
  }
}

double StageControls::velocity(const HeldDof& held, double mean) const {
  const auto motion = std::find_if(motions_.begin(), motions_.end(), [&](const Motion& other) {
    return other.control == held.displacement;
  });
  return motion == motions_.end() ? mean : motion->rate[to_size(stage_)];
}

}  // namespace der
