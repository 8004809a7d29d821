#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/joint_rotations.hpp"
#include "der/steppers/work.hpp"

namespace der {

/// Completes a step that is done, the same for every stepper.
class StepCommit {
 public:
  /// Whose velocities held degrees of freedom have at the end of a step: those of their prescribed
  /// motion, or those that the scheme makes of it, as it does for free ones. Viscous forces are
  /// differences of velocities over an edge, in which the error of the scheme cancels only if both
  /// ends have it.
  enum class HeldVelocities { OfMotion, OfScheme };
  /// Who moves the rotations that lag behind by internal damping: this, or the scheme, as it does
  /// nodes, if it is L-stable and keeps its order for them.
  enum class LaggingRotations { OfCommit, OfScheme };
  explicit StepCommit(const Model& model, HeldVelocities held = HeldVelocities::OfMotion,
                      LaggingRotations lagging = LaggingRotations::OfCommit);
  [[nodiscard]] HeldVelocities held_velocities() const { return held_velocities_; }

  /// Moves `state`, still at the start of a step of `dt` [s], to its end, where free degrees of
  /// freedom have the `velocities` [m/s], and held ones, too, if they are the scheme's.
  /// Accumulates the work of clamps that turn, of moments on their cells (model/moment_place.hpp),
  /// of a change of gravity, and of what moves held nodes against their inertia and drag; all else
  /// is the stepper's to accumulate.
  void finish(const Vector& positions, const Eigen::Ref<const Vector>& velocities, double dt,
              State& state);

 private:
  ControlWork follow_and_work(State& state);
  void move_rotations(double dt, State& state);
  double driven_power(const Configuration& here, const State& state, double dt, double time);

  const Model& model_;
  HeldVelocities held_velocities_;
  JointRotations rotations_;
  bool advances_rotations_ = false;
  bool controls_work_ = false;  // whether any control does work without a displacement
  Configuration start_;
  Vector start_velocities_;  // where rotations lag behind
  Configuration end_;
  Configuration ahead_;   // the start with the controls of the end
  Configuration behind_;  // the end with the controls of the start
  Vector turn_rates_;
};

}  // namespace der
