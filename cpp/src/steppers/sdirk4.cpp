#include <array>

#include "der/core/index.hpp"
#include "der/steppers/implicit_stage.hpp"
#include "der/steppers/work.hpp"
#include "steppers.hpp"

namespace der {
namespace {

/// The diagonally implicit Runge-Kutta method of order 4 with five stages of Hairer and Wanner
/// (Solving Ordinary Differential Equations II, table IV.6.5): L-stable, one-step, its last stage
/// is the result. A stage solves, with g = dt/4,
///   q_i = q + D_i + g v_i,  v_i = V_i + g a_i,  M a_i = F(q_i, v_i, t + c_i dt),
/// D_i being what the stages before contribute, and V_i that and v.
class Sdirk4 final : public Stepper {
 public:
  Sdirk4(const Model& model, const Assembler& assembler, LinearSolver& solver,
         const StepperOptions& options)
      : model_(model),
        stage_(model, assembler, solver, options.newton),
        past_displacement_(model.num_dofs()),
        past_velocities_(model.num_dofs()),
        end_held_(model.num_dofs()),
        displacement_(model.num_dofs()),
        velocities_(model.num_dofs(), kStages),
        accelerations_(model.num_dofs(), kStages) {}

  StepReport step(State& state, double dt) override {
    const double g = kDiagonal * dt;
    stage_.equation.inertia = 1.0 / (g * g);
    stage_.equation.velocity_factor = 1.0 / g;
    end_held_ = state.positions;
    stage_.place_held_at(state, state.time + dt, end_held_);
    work_ = state.work;

    StepReport report;
    for (Index i = 0; i < kStages; ++i) {
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
      // The stages' works count with their weights in the result, the last row.
      const double weight = i + 1 < kStages ? kWeights.back()[at(i)] : kDiagonal;
      stage_displacement(model_, state.positions, end_held_, weight, dt, velocities_.col(i),
                         displacement_);
      stage_.book(displacement_, work_);
    }
    state.work = work_;
    state.accelerations = accelerations_.col(kStages - 1);
    stage_.finish(stage_.positions, velocities_.col(kStages - 1), dt, state);
    return report;
  }

 private:
  static constexpr Index kStages = 5;
  static constexpr double kDiagonal = 0.25;
  static constexpr std::array<double, at(kStages)> kTimes{1.0 / 4.0, 3.0 / 4.0, 11.0 / 20.0,
                                                          1.0 / 2.0, 1.0};
  /// Below the diagonal.
  static constexpr std::array<std::array<double, at(kStages - 1)>, at(kStages)> kWeights{{
      {},
      {1.0 / 2.0},
      {17.0 / 50.0, -1.0 / 25.0},
      {371.0 / 1360.0, -137.0 / 2720.0, 15.0 / 544.0},
      {25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0},
  }};

  StepReport solve_stage(Index i, const State& state, double dt) {
    const double g = kDiagonal * dt;
    const double time = state.time + kTimes[at(i)] * dt;
    const Eigen::Map<const Eigen::Vector4d> weights(kWeights[at(i)].data());
    past_velocities_ = state.velocities;
    past_displacement_.noalias() = velocities_.leftCols(i) * (dt * weights.head(i));
    past_velocities_.noalias() += accelerations_.leftCols(i) * (dt * weights.head(i));
    stage_.positions = state.positions + past_displacement_ + g * past_velocities_;
    // The acceleration is guessed to be that of the stage before.
    if (i == 0) {
      stage_.positions += g * g * state.accelerations;
    } else {
      stage_.positions += g * g * accelerations_.col(i - 1);
    }
    stage_.place_held_at(state, time, stage_.positions);
    for (const HeldDof& held : model_.held) {
      // So that the stage's velocity is that of the motion over the step.
      past_displacement_[held.dof] = stage_.positions[held.dof] - state.positions[held.dof] -
                                     kDiagonal * (end_held_[held.dof] - state.positions[held.dof]);
    }
    stage_.equation.inertia_target = past_displacement_ + g * past_velocities_;
    stage_.equation.velocity_reference = past_displacement_;
    return stage_.solve(state, time);
  }

  const Model& model_;
  ImplicitStage stage_;
  Vector past_displacement_;
  Vector past_velocities_;
  Vector end_held_;  // held degrees of freedom at the end of the step
  Vector displacement_;
  Eigen::Matrix<double, Eigen::Dynamic, kStages> velocities_;  // of each stage, a column
  Eigen::Matrix<double, Eigen::Dynamic, kStages> accelerations_;
  Work work_;
};

}  // namespace

std::unique_ptr<Stepper> make_sdirk4(const Model& model, const Assembler& assembler,
                                     LinearSolver& solver, const StepperOptions& options) {
  return std::make_unique<Sdirk4>(model, assembler, solver, options);
}

}  // namespace der
