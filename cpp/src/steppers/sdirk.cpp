#include <array>

#include "der/core/index.hpp"
#include "der/steppers/implicit_stage.hpp"
#include "der/steppers/work.hpp"
#include "steppers.hpp"

namespace der {
namespace {

constexpr Index kStages = 5;

/// Coefficients of a singly diagonally implicit Runge-Kutta method.
struct Tableau {
  double diagonal = 0.0;
  std::array<std::array<double, at(kStages - 1)>, at(kStages)> below;  ///< the diagonal, by stages
  std::array<double, at(kStages)> weights;                             ///< of the stages' slopes

  /// Of a stage, from the start of the step, over its length.
  [[nodiscard]] double time(Index stage) const {
    double sum = diagonal;
    for (const double weight : below[at(stage)]) sum += weight;
    return sum;
  }
};

/// Order 4, L-stable, the last stage is the result (Hairer and Wanner, Solving Ordinary
/// Differential Equations II, table IV.6.5).
constexpr Tableau kOrder4{1.0 / 4.0,
                          {{{},
                            {1.0 / 2.0},
                            {17.0 / 50.0, -1.0 / 25.0},
                            {371.0 / 1360.0, -137.0 / 2720.0, 15.0 / 544.0},
                            {25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0}}},
                          {25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0, 1.0 / 4.0}};

/// Order 5, L-stable (SDIRK5()5L[1] of Kennedy and Carpenter, Diagonally Implicit Runge-Kutta
/// Methods for Ordinary Differential Equations, NASA/TM-2016-219173, section 5.3).
constexpr Tableau kOrder5{
    4024571134387.0 / 14474071345096.0,
    {{{},
      {9365021263232.0 / 12572342979331.0},
      {2144716224527.0 / 9320917548702.0, -397905335951.0 / 4008788611757.0},
      {-291541413000.0 / 6267936762551.0, 226761949132.0 / 4473940808273.0,
       -1282248297070.0 / 9697416712681.0},
      {-2481679516057.0 / 4626464057815.0, -197112422687.0 / 6604378783090.0,
       3952887910906.0 / 9713059315593.0, 4906835613583.0 / 8134926921134.0}}},
    {-2522702558582.0 / 12162329469185.0, 1018267903655.0 / 12907234417901.0,
     4542392826351.0 / 13702606430957.0, 5001116467727.0 / 12224457745473.0,
     1509636094297.0 / 3891594770934.0}};

/// A stage solves, with g the diagonal times dt,
///   q_i = q + D_i + g v_i,  v_i = V_i + g a_i,  M a_i = F(q_i, v_i, t + c_i dt),
/// D_i being what the stages before contribute, and V_i that and v. The result is
///   q' = q + dt sum b_i v_i,  v' = v + dt sum b_i a_i.
class Sdirk final : public Stepper {
 public:
  Sdirk(const Tableau& tableau, const Model& model, const Assembler& assembler,
        LinearSolver& solver, const StepperOptions& options)
      : tableau_(tableau),
        model_(model),
        stage_(model, assembler, solver, options.newton),
        past_displacement_(model.num_dofs()),
        past_velocities_(model.num_dofs()),
        end_positions_(model.num_dofs()),
        displacement_(model.num_dofs()),
        velocities_(model.num_dofs(), kStages),
        accelerations_(model.num_dofs(), kStages) {}

  StepReport step(State& state, double dt) override {
    const double g = tableau_.diagonal * dt;
    stage_.equation.inertia = 1.0 / (g * g);
    stage_.equation.velocity_factor = 1.0 / g;
    stage_.end_step_at(state.time + dt);
    end_positions_ = state.positions;
    stage_.place_held_at(state, state.time + dt, end_positions_);
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
      // The stages' works count with their weights in the result.
      stage_displacement(model_, state.positions, end_positions_, tableau_.weights[at(i)], dt,
                         velocities_.col(i), displacement_);
      stage_.book(displacement_, work_);
    }
    finish(state, dt);
    return report;
  }

 private:
  StepReport solve_stage(Index i, const State& state, double dt) {
    const double g = tableau_.diagonal * dt;
    const double time = state.time + tableau_.time(i) * dt;
    const Eigen::Map<const Eigen::Vector4d> weights(tableau_.below[at(i)].data());
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
      past_displacement_[held.dof] =
          stage_.positions[held.dof] - state.positions[held.dof] -
          tableau_.diagonal * (end_positions_[held.dof] - state.positions[held.dof]);
    }
    stage_.equation.inertia_target = past_displacement_ + g * past_velocities_;
    stage_.equation.velocity_reference = past_displacement_;
    return stage_.solve(state, time);
  }

  void finish(State& state, double dt) {
    const Eigen::Map<const Eigen::Matrix<double, kStages, 1>> weights(tableau_.weights.data());
    state.work = work_;
    state.accelerations = accelerations_.col(kStages - 1);  // the next guess
    displacement_.noalias() = velocities_ * (dt * weights);
    past_velocities_.noalias() = accelerations_ * (dt * weights);
    for (const Index dof : model_.free_dofs) {
      end_positions_[dof] = state.positions[dof] + displacement_[dof];
    }
    past_velocities_ += state.velocities;
    stage_.finish(end_positions_, past_velocities_, dt, state);
  }

  const Tableau& tableau_;
  const Model& model_;
  ImplicitStage stage_;
  Vector past_displacement_;
  Vector past_velocities_;
  Vector end_positions_;  // of held degrees of freedom, then of all
  Vector displacement_;
  Eigen::Matrix<double, Eigen::Dynamic, kStages> velocities_;  // of each stage, a column
  Eigen::Matrix<double, Eigen::Dynamic, kStages> accelerations_;
  Work work_;
};

}  // namespace

std::unique_ptr<Stepper> make_sdirk4(const Model& model, const Assembler& assembler,
                                     LinearSolver& solver, const StepperOptions& options) {
  return std::make_unique<Sdirk>(kOrder4, model, assembler, solver, options);
}

std::unique_ptr<Stepper> make_sdirk5(const Model& model, const Assembler& assembler,
                                     LinearSolver& solver, const StepperOptions& options) {
  return std::make_unique<Sdirk>(kOrder5, model, assembler, solver, options);
}

}  // namespace der
