#pragma once

#include <limits>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// The controls at the stages of an implicit step. Stages beyond the step's end extrapolate tables
/// that have a kink there.
class StageControls {
 public:
  explicit StageControls(const Model& model)
      : model_(model), start_(Vector::Zero(model.tables.size())) {}

  /// Sets the end of the current step [s].
  void end_step_at(double time) { step_end_ = time; }
  /// Sets `controls` to those at `time` [s] of a step that begins at `state`.
  void evaluate(const State& state, double time, Vector& controls);

 private:
  const Model& model_;
  Vector start_;
  double step_end_ = std::numeric_limits<double>::infinity();
};

}  // namespace der
