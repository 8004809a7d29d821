#pragma once

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/solvers/low_rank.hpp"
#include "der/solvers/newton_problem.hpp"
#include "der/solvers/predicted_tension.hpp"

namespace der {

class DiscreteGradientAssembler;

/// The nonlinear system that one stage of an implicit stepper, or a static analysis, has to solve
/// for the displacement d from the positions `origin`:
///   inertia M (d - inertia_target) + (C + V(origin + d)) v + grad E(origin + d)
///     - Q(origin + d) - force = 0,   v = velocity_factor (d - velocity_reference),
/// over the free degrees of freedom; Q are the circulatory loads, M is `mass`, C the model's
/// diagonal damping, V that inside of rods (model/internal_damping.hpp). All vectors have one entry
/// a degree of freedom. The velocity that a stepper makes of a displacement has the rounding error
/// of the displacement; that of a difference of positions grows as steps get short.
struct Stage {
  explicit Stage(const Model& model);
  double inertia = 0.0;          ///< [1/s^2]; 0: statics
  Vector origin;                 ///< [m]; zero unless set
  Vector inertia_target;         ///< [m] from the origin
  double velocity_factor = 0.0;  ///< [1/s]
  Vector velocity_reference;     ///< [m] from the origin
  Vector force;                  ///< [N] external forces at the stage's time
  Vector turn_rates;  ///< of the controls, with internal damping (model/internal_damping.hpp)
  /// Whether the stage is one of a motion. The rates of angles are then spins of sections, which
  /// change the forces on nodes (model/spin.hpp).
  bool is_motion = false;
  /// Whether all circulatory loads are zero: Newton's matrix is then symmetric, and the way to an
  /// equilibrium is the one without these loads.
  bool is_conservative = false;
  /// If set, it gives the forces in place of grad E: the stage is the middle of a step from
  /// `origin`.
  DiscreteGradientAssembler* discrete_gradient = nullptr;
};

/// A stage as Newton's method solves it, on preallocated memory: evaluations allocate nothing.
class StageProblem final : public NewtonProblem {
 public:
  /// `mass` [kg] is the model's, unless a static analysis brings its own.
  StageProblem(const Model& model, const Assembler& assembler, Mass mass);

  /// Poses a stage to be solved for the coordinates of `here`: on entry the guess, with held
  /// degrees of freedom already at their values, and the controls at the stage's time. Both must
  /// outlive the solve.
  void pose(const Stage& stage, Configuration& here);

  void begin(Vector& displacement) override;
  void begin_again(Vector& displacement) override;
  void solution_changed(const Vector& displacement) override;
  void residual(Vector& residual) override;
  void system(Vector& residual, Vector& values) override;
  [[nodiscard]] const LowRank* low_rank() const override {
    return circulatory_.empty() || stage_->is_conservative ? nullptr : &circulatory_;
  }
  void mixed_point_update(const Vector& step, double taken, Vector& values) override;
  void remove_mixed_point_part(Vector& values) override;
  StepBound largest_step(const Vector& step) override;
  [[nodiscard]] double acting_force() const override { return acting_; }
  [[nodiscard]] double position_rounding() const override;
  double residual_rounding(Vector& values) override;
  /// The largest gyroscopic force of an edge over the inertial force of its lighter node in the
  /// same motion. Newton's matrix leaves the former out: above about 1 it may not converge.
  [[nodiscard]] double gyroscopic_share() const;

 private:
  [[nodiscard]] double velocity(Index dof) const {
    return stage_->velocity_factor * (displacement_[dof] - stage_->velocity_reference[dof]);
  }
  [[nodiscard]] bool has_viscous_forces() const {
    return model_.viscous && stage_->velocity_factor != 0.0;
  }
  void set_circulatory_tangent();
  void add_spin_forces(Vector& residual) const;
  double subtract_external(Vector& residual) const;
  double add_diagonal_forces(double factor, const Vector& diagonal, const Vector& target,
                             Vector& residual);
  double add_viscous_forces(Vector& residual);
  void add_stage_forces(Vector& residual);

  const Model& model_;
  const Assembler& assembler_;
  Mass mass_;
  Vector mass_values_;  // the mass matrix as the assembler's values
  const Stage* stage_ = nullptr;
  Configuration* here_ = nullptr;
  PredictedTension tension_;
  LowRank circulatory_;  // tangent of the circulatory loads
  CirculatoryTerm term_of_load_;
  Vector guess_;         // coordinates
  Vector displacement_;  // from the stage's origin
  Vector term_;          // one term of the residual
  Vector velocities_;
  double external_ = 0.0;  // largest external force of the stage [N]
  double acting_ = 0.0;
};

}  // namespace der
