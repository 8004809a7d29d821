#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/newton.hpp"
#include "der/steppers/stepper.hpp"

namespace der {

/// What every implicit stepper shares: the equation of one stage, its solver, its unknown
/// positions.
class ImplicitStage {
 public:
  ImplicitStage(const Model& model, const Assembler& assembler, LinearSolver& solver,
                const NewtonOptions& options);

  /// Inertia and velocity terms, to be set by the stepper before `solve`.
  Stage equation;
  /// On entry to `solve` the guess, held degrees of freedom included; on exit the solution.
  Vector positions;

  /// Puts the held degrees of freedom of `where` to where the tables have them at `time`.
  void place_held_at(double time, Vector& where);
  /// Solves with tables and external forces at `time`.
  StepReport solve(const State& state, double time);
  /// Completes a done step from the old positions in `state` to `new_positions`: held degrees of
  /// freedom get the velocity of their motion over the step.
  void finish(const Vector& new_positions, const Vector& new_velocities, double dt,
              State& state) const;

 private:
  const Model& model_;
  Newton newton_;
};

}  // namespace der
