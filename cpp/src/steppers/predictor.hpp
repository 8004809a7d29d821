#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Positions from which Newton's method begins a step of a stepper that knows accelerations,
///   q + dt v + dt^2/2 a.
/// Where the step does not resolve the fastest motion, stretching mostly, its velocity and its
/// acceleration say nothing about the end of the step: the terms would be larger than the motion by
/// the factors w dt and (w dt)^2. A term that changes an edge by more than is plausible is left
/// out; without that of the velocity, that of the acceleration too.
class Predictor {
 public:
  explicit Predictor(const Model& model) : model_(model), term_(Vector::Zero(model.num_dofs())) {}

  /// Sets `positions` [m], over all degrees of freedom, to the guess for a step of `dt` [s].
  void evaluate(const State& state, double dt, Vector& positions);

 private:
  const Model& model_;
  Vector term_;
};

}  // namespace der
