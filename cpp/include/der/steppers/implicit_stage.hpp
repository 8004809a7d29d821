#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/newton.hpp"
#include "der/solvers/stage.hpp"
#include "der/steppers/explicit_force.hpp"
#include "der/steppers/stage_controls.hpp"
#include "der/steppers/step_commit.hpp"
#include "der/steppers/stepper.hpp"

namespace der {

/// The part that all implicit steppers share: the equation of one stage, its solver, its unknown
/// positions.
class ImplicitStage {
 public:
  /// Whose velocities held degrees of freedom have in the stages of a stepper that can take either:
  /// the scheme's where there are viscous forces (StepCommit::HeldVelocities).
  static StepCommit::HeldVelocities held_velocities(const Model& model) {
    using HeldVelocities = StepCommit::HeldVelocities;
    return model.viscous ? HeldVelocities::OfScheme : HeldVelocities::OfMotion;
  }

  ImplicitStage(const Model& model, const Assembler& assembler, LinearSolver& solver,
                const NewtonOptions& options,
                StepCommit::HeldVelocities held = StepCommit::HeldVelocities::OfMotion,
                StepCommit::LaggingRotations lagging = StepCommit::LaggingRotations::OfCommit);

  /// Inertia and velocity terms, to be set by the stepper before `solve`; displacements are those
  /// from the start of the step.
  Stage equation;
  /// Its coordinates are on entry to `solve` the guess, held degrees of freedom included; on exit
  /// the solution, with the controls of the stage.
  Configuration here;

  /// Sets the end of the current step [s]. Stages beyond it extrapolate tables that have a kink
  /// there.
  [[nodiscard]] StageControls& controls() { return controls_; }
  /// Puts the held degrees of freedom of `where` to where the tables have them at `time`.
  void apply_prescribed_motion_at(const State& state, double time, Vector& where);
  /// Solves with tables and external forces at `time`.
  StepReport solve(const State& state, double time);
  /// Displacement of the stage solved last, from the start of the step [m].
  [[nodiscard]] const Vector& displacement() const { return newton_.displacement(); }
  /// Adds up what the forces of the stage solved last do along `displacement` [m].
  void accumulate(const Vector& displacement, Work& work);
  /// Completes a done step: positions, velocities and the works that do not depend on the stepper.
  void finish(const Vector& new_positions, const Eigen::Ref<const Vector>& new_velocities,
              double dt, State& state) {
    finisher_.finish(new_positions, new_velocities, dt, state);
  }
  /// Accumulates the works along the displacement of the step and finishes it; for steppers of one
  /// stage.
  void accumulate_and_finish(const Vector& new_positions,
                             const Eigen::Ref<const Vector>& new_velocities, double dt,
                             State& state);
  /// Does the same for a stage at the fraction `place` of the step, at least one half. The forces
  /// at the start of the step enter as well, so that works are second-order accurate.
  void accumulate_and_finish(const Vector& new_positions,
                             const Eigen::Ref<const Vector>& new_velocities, double dt,
                             double place, ExplicitForce& at_start, State& state);

 private:
  void accumulate_forces(const Vector& displacement, Work& work);
  void accumulate_solver(const Vector& displacement, Work& work) const;
  /// Work [J] of the moments.
  [[nodiscard]] double moments(const Vector& displacement) const;

  const Model& model_;
  StageProblem problem_;
  Newton newton_;
  StepCommit finisher_;
  StageControls controls_;
  Vector held_controls_;  // those of `here` are the solved stage's until it is accumulated
  Vector displacement_;
  Vector start_velocities_;
  Vector velocities_;  // of the stage
  Vector viscous_;     // forces [N]
};

}  // namespace der
