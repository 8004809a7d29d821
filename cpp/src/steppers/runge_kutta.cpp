#include <optional>

#include "der/core/index.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/steppers/explicit_force.hpp"
#include "der/steppers/implicit_stage.hpp"
#include "der/steppers/tableau.hpp"
#include "der/steppers/work.hpp"
#include "steppers/steppers.hpp"

namespace der {
namespace {

/// A diagonally implicit Runge-Kutta method for q' = v, M v' = F. An implicit stage solves, with g
/// the diagonal times dt,
///   q_i = q + D_i + g v_i,  v_i = V_i + g a_i,  M a_i = F(q_i, v_i, t + c_i dt),
/// D_i being what the stages before contribute, and V_i that and v. The result is
///   q' = q + dt sum b_i v_i,  v' = v + dt sum b_i a_i.
class DiagonallyImplicitRungeKutta final : public Stepper {
 public:
  DiagonallyImplicitRungeKutta(const Tableau& tableau, const Model& model,
                               const Assembler& assembler, LinearSolver& solver,
                               const StepperOptions& options)
      : tableau_(tableau),
        model_(model),
        stage_(model, assembler, solver, options.newton, ImplicitStage::held_velocities(model),
               tableau.is_l_stable() ? StepCommit::LaggingRotations::OfScheme
                                     : StepCommit::LaggingRotations::OfCommit),
        start_acceleration_(model.num_dofs()),
        past_displacement_(model.num_dofs()),
        past_velocities_(model.num_dofs()),
        end_positions_(model.num_dofs()),
        displacement_(model.num_dofs()),
        velocities_(model.num_dofs(), tableau.stages),
        accelerations_(model.num_dofs(), tableau.stages) {
    if (tableau.explicit_first) start_force_.emplace(model, assembler);
  }

  StepReport step(State& state, double dt) override {
    const double g = tableau_.diagonal * dt;
    stage_.equation.inertia = 1.0 / (g * g);
    stage_.equation.velocity_factor = 1.0 / g;
    stage_.controls().begin_step(state, dt, tableau_);
    end_positions_ = state.positions;
    stage_.apply_prescribed_motion_at(state, state.time + dt, end_positions_);
    work_ = state.work;

    StepReport report;
    for (Index i = 0; i < tableau_.stages; ++i) {
      if (!tableau_.is_implicit(i)) {
        evaluate_start(state, dt);
        continue;
      }
      const StepReport solved = solve_stage(i, state, dt);
      report.newton_iterations += solved.newton_iterations;
      if (solved.outcome != StepOutcome::Done) {
        report.outcome = solved.outcome;
        report.worst_dof = solved.worst_dof;
        report.failure = solved.failure;
        return report;
      }
      velocities_.col(i) = (stage_.displacement() - past_displacement_) * (1.0 / g);
      accelerations_.col(i) = (velocities_.col(i) - past_velocities_) * (1.0 / g);
      set_displacement(i, state, dt);
      stage_.accumulate(displacement_, work_);
    }
    finish(state, dt);
    return report;
  }

 private:
  /// The first stage of a method that begins with an explicit one.
  void evaluate_start(const State& state, double dt) {
    past_velocities_ = state.velocities;
    if (!model_.viscous) {
      velocities_in_step(model_, state, end_positions_, dt, state.time, past_velocities_);
    }
    start_force_->set_rotation_rates(state, past_velocities_);
    velocities_.col(0) = past_velocities_;
    start_force_->acceleration(state, state.positions, past_velocities_, state.time, 0.0,
                               start_acceleration_);
    accelerations_.col(0) = start_acceleration_;
    set_displacement(0, state, dt);
    start_force_->accumulate(past_velocities_, displacement_, work_);
  }

  /// Sets what a stage contributes to the motion of the step; its works count likewise.
  void set_displacement(Index i, const State& state, double dt) {
    stage_displacement(model_, state.positions, end_positions_, tableau_.weights[to_size(i)], dt,
                       velocities_.col(i), displacement_);
  }

  StepReport solve_stage(Index i, const State& state, double dt) {
    const double g = tableau_.diagonal * dt;
    const double time = state.time + tableau_.time(i) * dt;
    past_displacement_.setZero();
    past_velocities_ = state.velocities;
    for (Index j = 0; j < i; ++j) {
      const double weight = dt * tableau_.below[to_size(i)][to_size(j)];
      past_displacement_ += weight * velocities_.col(j);
      past_velocities_ += weight * accelerations_.col(j);
    }
    stage_.here.coordinates = state.positions + past_displacement_ + g * past_velocities_;
    // The acceleration is guessed to be that of the stage before.
    if (i == 0) {
      stage_.here.coordinates += g * g * state.accelerations;
    } else {
      stage_.here.coordinates += g * g * accelerations_.col(i - 1);
    }
    stage_.controls().enter_stage(i);
    stage_.apply_prescribed_motion_at(state, time, stage_.here.coordinates);
    if (!model_.viscous) hold_velocities(state, dt, g);
    stage_.equation.inertia_target = past_displacement_ + g * past_velocities_;
    stage_.equation.velocity_reference = past_displacement_;
    return stage_.solve(state, time);
  }

  /// So that the stage's velocities of held degrees of freedom are those of the motion.
  void hold_velocities(const State& state, double dt, double g) {
    for (const HeldDof& held : model_.held) {
      const double mean = (end_positions_[held.dof] - state.positions[held.dof]) / dt;
      past_displacement_[held.dof] = stage_.here.coordinates[held.dof] - state.positions[held.dof] -
                                     g * stage_.controls().velocity(held, mean);
    }
  }

  void finish(State& state, double dt) {
    const Index last = tableau_.stages - 1;
    state.work = work_;
    state.accelerations = accelerations_.col(last);  // the next guess
    if (tableau_.stiffly_accurate()) {
      stage_.finish(stage_.here.coordinates, velocities_.col(last), dt, state);
      return;
    }
    displacement_.setZero();
    past_velocities_ = state.velocities;
    for (Index i = 0; i <= last; ++i) {
      const double weight = dt * tableau_.weights[to_size(i)];
      displacement_ += weight * velocities_.col(i);
      past_velocities_ += weight * accelerations_.col(i);
    }
    for (const Index dof : model_.dofs.free()) {
      end_positions_[dof] = state.positions[dof] + displacement_[dof];
    }
    stage_.finish(end_positions_, past_velocities_, dt, state);
  }

  const Tableau& tableau_;
  const Model& model_;
  ImplicitStage stage_;
  std::optional<ExplicitForce> start_force_;  // of an explicit first stage
  Vector start_acceleration_;
  Vector past_displacement_;
  Vector past_velocities_;
  Vector end_positions_;  // of held degrees of freedom, then of all
  Vector displacement_;
  Eigen::MatrixXd velocities_;  // of each stage, a column
  Eigen::MatrixXd accelerations_;
  Work work_;
};

}  // namespace

template <const Tableau& tableau>
std::unique_ptr<Stepper> make_runge_kutta(const Model& model, const Assembler& assembler,
                                          LinearSolver& solver, const StepperOptions& options) {
  // The check sees parentheses that only the instantiation has.
  // NOLINTNEXTLINE(readability-redundant-parentheses)
  return std::make_unique<DiagonallyImplicitRungeKutta>(tableau, model, assembler, solver, options);
}

template decltype(make_runge_kutta<kImplicitEuler>) make_runge_kutta<kImplicitEuler>;
template decltype(make_runge_kutta<kImplicitMidpoint>) make_runge_kutta<kImplicitMidpoint>;
template decltype(make_runge_kutta<kTrBdf2>) make_runge_kutta<kTrBdf2>;
template decltype(make_runge_kutta<kSdirk4>) make_runge_kutta<kSdirk4>;
template decltype(make_runge_kutta<kSdirk5>) make_runge_kutta<kSdirk5>;

}  // namespace der
