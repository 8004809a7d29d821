#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/newton.hpp"
#include "der/steppers/stepper.hpp"

namespace der {

/// What every implicit stepper shares: one stage's equation, its solver and its unknown positions.
class ImplicitStage {
 public:
  ImplicitStage(const Model& model, const Assembler& assembler, LinearSolver& solver,
                const NewtonOptions& options);

  /// Inertia and velocity terms, to be set by the stepper before `solve`.
  Stage equation;
  /// On entry to `solve` the guess, on exit the solution.
  Vector positions;

  /// Evaluates tables and forces at `time`, places the held degrees of freedom, and solves.
  StepReport solve(const State& state, double time);

 private:
  const Model& model_;
  Newton newton_;
};

}  // namespace der
