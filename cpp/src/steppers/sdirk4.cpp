#include <array>

#include "der/steppers/implicit_stage.hpp"
#include "steppers.hpp"

namespace der {
namespace {

/// The diagonally implicit Runge-Kutta method of order 4 with five stages of Hairer and Wanner
/// (Solving Ordinary Differential Equations II, table IV.6.5): L-stable, one-step, its last stage
/// is the result. A stage solves, with g = dt/4,
///   q_i = Q_i + g v_i,  v_i = V_i + g a_i,  M a_i = F(q_i, v_i, t + c_i dt),
/// Q_i and V_i being q and v plus what the stages before contribute.
class Sdirk4 final : public Stepper {
 public:
  Sdirk4(const Model& model, const Assembler& assembler, LinearSolver& solver,
         const StepperOptions& options)
      : model_(model),
        stage_(model, assembler, solver, options.newton),
        past_positions_(model.num_dofs()),
        past_velocities_(model.num_dofs()),
        end_held_(model.num_dofs()),
        displacement_(model.num_dofs()) {
    velocities_.fill(Vector::Zero(model.num_dofs()));
    accelerations_.fill(Vector::Zero(model.num_dofs()));
  }

  StepReport step(State& state, double dt) override {
    const double g = kDiagonal * dt;
    stage_.equation.inertia = 1.0 / (g * g);
    stage_.equation.velocity_factor = 1.0 / g;
    end_held_ = state.positions;
    stage_.place_held_at(state, state.time + dt, end_held_);
    work_ = state.work;

    StepReport report;
    for (std::size_t i = 0; i < kStages; ++i) {
      const StepReport solved = solve_stage(i, state, dt);
      report.newton_iterations += solved.newton_iterations;
      if (solved.outcome != StepOutcome::Done) {
        report.outcome = solved.outcome;
        report.worst_dof = solved.worst_dof;
        report.failure = solved.failure;
        return report;
      }
      velocities_[i] = (stage_.positions - past_positions_) / g;
      accelerations_[i] = (velocities_[i] - past_velocities_) / g;
      book_stage(i, state, dt);
    }
    state.work = work_;
    state.accelerations = accelerations_.back();
    stage_.finish(stage_.positions, velocities_.back(), dt, state);
    return report;
  }

 private:
  static constexpr std::size_t kStages = 5;
  static constexpr double kDiagonal = 0.25;
  static constexpr std::array<double, kStages> kTimes{1.0 / 4.0, 3.0 / 4.0, 11.0 / 20.0, 1.0 / 2.0,
                                                      1.0};
  /// Below the diagonal.
  static constexpr std::array<std::array<double, kStages - 1>, kStages> kWeights{{
      {},
      {1.0 / 2.0},
      {17.0 / 50.0, -1.0 / 25.0},
      {371.0 / 1360.0, -137.0 / 2720.0, 15.0 / 544.0},
      {25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0},
  }};

  StepReport solve_stage(std::size_t i, const State& state, double dt) {
    const double g = kDiagonal * dt;
    const double time = state.time + kTimes[i] * dt;
    past_positions_ = state.positions;
    past_velocities_ = state.velocities;
    for (std::size_t j = 0; j < i; ++j) {
      past_positions_ += kWeights[i][j] * dt * velocities_[j];
      past_velocities_ += kWeights[i][j] * dt * accelerations_[j];
    }
    // The acceleration is guessed to be that of the stage before.
    const Vector& guess = i == 0 ? state.accelerations : accelerations_[i - 1];
    stage_.positions = past_positions_ + g * (past_velocities_ + g * guess);
    stage_.place_held_at(state, time, stage_.positions);
    for (const HeldDof& held : model_.held) {
      // So that the stage's velocity is that of the motion over the step.
      past_positions_[held.dof] = stage_.positions[held.dof] -
                                  kDiagonal * (end_held_[held.dof] - state.positions[held.dof]);
    }
    stage_.equation.inertia_target = past_positions_ + g * past_velocities_;
    stage_.equation.velocity_reference = past_positions_;
    return stage_.solve(state, time);
  }

  /// The stages' works count with their weights in the result, the last row.
  void book_stage(std::size_t i, const State& state, double dt) {
    const double weight = i + 1 < kStages ? kWeights.back()[i] : kDiagonal;
    displacement_ = weight * dt * velocities_[i];
    for (const HeldDof& held : model_.held) {
      displacement_[held.dof] = weight * (end_held_[held.dof] - state.positions[held.dof]);
    }
    stage_.book(displacement_, work_);
  }

  const Model& model_;
  ImplicitStage stage_;
  std::array<Vector, kStages> velocities_;
  std::array<Vector, kStages> accelerations_;
  Vector past_positions_;
  Vector past_velocities_;
  Vector end_held_;  // held degrees of freedom at the end of the step
  Vector displacement_;
  Work work_;
};

}  // namespace

std::unique_ptr<Stepper> make_sdirk4(const Model& model, const Assembler& assembler,
                                     LinearSolver& solver, const StepperOptions& options) {
  return std::make_unique<Sdirk4>(model, assembler, solver, options);
}

}  // namespace der
