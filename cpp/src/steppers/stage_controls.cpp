#include "der/steppers/stage_controls.hpp"

#include <algorithm>
#include <cmath>

#include "der/model/prescribed_motion.hpp"

namespace der {
namespace {

/// A tangent that turns further in a step [rad] keeps to its circle: the mean of two of its
/// directions tells little.
constexpr double kMostTurned = 1.0;

}  // namespace

StageControls::StageControls(const Model& model)
    : model_(model),
      start_(Vector::Zero(model.tables.size())),
      end_(Vector::Zero(model.tables.size())) {
  for (const PrescribedControl& each : model.prescribed) {
    const auto is_same = [&](const Motion& other) { return other.control == each.control; };
    if (std::any_of(motions_.begin(), motions_.end(), is_same)) continue;
    motions_.push_back({each.control});
  }
  for (const RodMesh& rod : model.rods) {
    for (const Clamp& clamp : rod.clamps) {
      for (std::size_t i = 0; i < motions_.size(); ++i) {
        const bool turns = clamp.held.inset >= 0 && motions_[i].control == clamp.held.rotation;
        if (turns) turns_.push_back({i, clamp.held.inset});
      }
    }
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
  find_turns(dt);
}

void StageControls::begin_step(const State& state, double dt, const Tableau& tableau) {
  tableau_ = &tableau;
  find_means(state, dt);
  for (Motion& motion : motions_) {
    const double mean = motion.rate[0];
    for (Index i = 0; i < tableau.stages; ++i) {
      const double time = state.time + tableau.time(i) * dt;
      motion.rate[to_size(i)] = control_rate(model_, state, motion.control, time, mean);
    }
    end_at(mean, motion.rate);
  }
  find_turns(dt);
}

void StageControls::find_turns(double dt) {
  for (Turn& turn : turns_) {
    const Rates<double>& rate = motions_[turn.motion].rate;
    const double angle = end_[motions_[turn.motion].control] - motions_[turn.motion].start;
    turn.is_mean = std::abs(angle) <= kMostTurned;
    const std::complex<double> mean = (std::polar(1.0, angle) - 1.0) / dt;
    turn.rate.fill(mean);
    if (tableau_ == nullptr) continue;
    for (Index i = 0; i < tableau_->stages; ++i) {
      const double here = dt * integral(rate, i);
      turn.rate[to_size(i)] = std::complex<double>(0.0, rate[to_size(i)]) * std::polar(1.0, here);
    }
    end_at(mean, turn.rate);
  }
}

/// So that the step ends where the tables have the support.
template <class T>
void StageControls::end_at(const T& mean, Rates<T>& rates) const {
  T excess = -mean;
  for (Index i = 0; i < tableau_->stages; ++i) {
    excess += tableau_->weights[to_size(i)] * rates[to_size(i)];
  }
  for (Index i = 0; i < tableau_->stages; ++i) rates[to_size(i)] -= excess;
}

template <class T>
T StageControls::integral(const Rates<T>& rates, Index stage) const {
  T sum = tableau_->diagonal * rates[to_size(stage)];
  for (Index j = 0; j < stage; ++j) {
    sum += tableau_->below[to_size(stage)][to_size(j)] * rates[to_size(j)];
  }
  return sum;
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
    model_.natural_strain.enter(controls);
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
  const double share = (time - state.time) / dt;
  const auto moved = [&](const auto& rates) {
    return tableau_ == nullptr ? dt * share * rates[0] : dt * integral(rates, stage_);
  };
  for (const Motion& motion : motions_)
    controls[motion.control] = motion.start + moved(motion.rate);
  for (const Turn& turn : turns_) {
    if (!turn.is_mean) continue;
    const Motion& motion = motions_[turn.motion];
    const std::complex<double> point = 1.0 + moved(turn.rate);
    controls[motion.control] = motion.start + std::arg(point);
    controls[turn.inset] = 1.0 - std::abs(point);
  }
}

double StageControls::velocity(const HeldDof& held, double mean) const {
  const auto motion = std::find_if(motions_.begin(), motions_.end(), [&](const Motion& other) {
    return other.control == held.displacement;
  });
  return motion == motions_.end() ? mean : held.weight * motion->rate[to_size(stage_)];
}

}  // namespace der
