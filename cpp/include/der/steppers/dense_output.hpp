#pragma once

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/joint_rotations.hpp"
#include "der/steppers/explicit_force.hpp"

namespace der {

/// The state within a step.
///
/// Positions follow the cubics that have the values and velocities of both ends, velocities their
/// slopes, and works the cubics that have the works accumulated at both ends and the powers there.
/// So a work is right to the order of the motion, and that of a constant force is exactly the force
/// along the interpolated path. Held degrees of freedom are where the tables have them, with the
/// velocity that `StepCommit` gives them for the step: where it jumps, it does so at the start.
class DenseOutput {
 public:
  DenseOutput(const Model& model, const Assembler& assembler);

  /// Sets positions, velocities, works and time of `result` to those at `time` [s] within the step
  /// from `start` to `end`, in which tables are straight; everything else is that of `end`.
  void evaluate(double time, const State& start, const State& end, State& result);

 private:
  /// Powers [W] at `where`, the start or the end of the step.
  Work powers(const State& where, const State& start, const State& end);
  /// Adds the powers [W] of what turns with the tables: clamps, and cells under moments.
  void add_table_powers(const State& where, const State& start, const State& end, Work& power);

  const Model& model_;
  ExplicitForce force_;
  JointRotations rotations_;
  Vector velocities_;
  Vector controls_;
  Vector turn_rates_;
  Configuration before_;
  Configuration after_;
};

}  // namespace der
