#pragma once

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/joint_rotations.hpp"
#include "der/solvers/mass_solver.hpp"
#include "der/steppers/stepper.hpp"

namespace der {

/// The forces at a given state, and the other parts that all explicit steppers share: the
/// acceleration, the motion of held degrees of freedom, and the check that the motion has not blown
/// up.
class ExplicitForce {
 public:
  ExplicitForce(const Model& model, const Assembler& assembler);

  /// Sets `acceleration` [m/s^2] to (M + t C)^-1 (external - grad E - C v) at `time`, 0 on held
  /// degrees of freedom. `damping_time` t [s] 0: the acceleration as it is; half a step: the mean
  /// one over the step under the damping and the gyroscopic forces (model/spin.hpp) of the mean
  /// velocity v + t a, which for the latter takes a few rounds. False: these rounds did not
  /// converge; they do where t is zero. Internal damping is that of the velocity v + t a' with the
  /// acceleration a' under that of v.
  bool acceleration(const State& state, const Vector& positions, const Vector& velocities,
                    double time, double damping_time, Vector& acceleration);
  /// Adds to an acceleration [m/s^2] at `state` what the gyroscopic forces make of a change of the
  /// velocities of nodes [m/s].
  void add_gyroscopic_change(const State& state, const Vector& change, Vector& acceleration);
  /// Moves the rotations of `positions` to a time `dt` [s] from that of `state`, where nodes have
  /// the positions and `velocities`.
  void advance_rotations(const State& state, double dt, const Vector& velocities,
                         Vector& positions);
  /// Sets the rates of rotations that lag behind at `state`.
  void set_rotation_rates(const State& state, Vector& velocities);
  /// Evaluates at `time` what `accumulate` needs, which is less than the acceleration does.
  void evaluate_works(const State& state, const Vector& positions, const Vector& velocities,
                      double time);
  /// Adds up what the forces evaluated last do along `displacement` [m], with the damping of
  /// `velocities` [m/s]. Along a velocity in place of the displacement: powers [W].
  void accumulate(const Vector& velocities, const Vector& displacement, Work& work) const;
  /// Puts held degrees of freedom of `positions` where the tables have them at `time`.
  void apply_prescribed_motion_at(const State& state, double time, Vector& positions);
  /// Not done where a value is no longer a number, an edge is stretched beyond reason, or one whose
  /// whole turns count has turned too far from where it is in `state`.
  [[nodiscard]] StepReport check(const State& state, const Vector& positions) const;

 private:
  void evaluate_loads(const State& state, const Vector& positions, double time);
  void evaluate_gradient();
  void set_viscous_force(const State& state, const Vector& velocities, double time);
  template <class Velocity>
  void set_couple(const Velocity& velocity, Vector& couple) const;

  const Model& model_;
  const Assembler& assembler_;
  bool supports_move_;
  MassSolver mass_;
  JointRotations rotations_;
  Configuration here_;  // of the last evaluation
  Vector scratch_controls_;
  Vector force_;
  Vector gradient_;  // without what the transport of frames makes of torques
  Vector viscous_;   // forces of internal damping
  Vector turn_rates_;
  Vector mean_velocities_;
  Vector rates_;   // velocities with those of rotations that lag behind
  Vector couple_;  // gyroscopic forces on nodes
  Vector next_couple_;
};

}  // namespace der
