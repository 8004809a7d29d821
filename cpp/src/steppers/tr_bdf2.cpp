#include "der/steppers/explicit_force.hpp"
#include "der/steppers/implicit_stage.hpp"
#include "der/steppers/work.hpp"
#include "steppers.hpp"

namespace der {
namespace {

/// The trapezoidal rule over the part g = 2 - sqrt(2) of the step, then BDF2 over its end (Bank et
/// al., IEEE Trans. CAD 4, 1985; Hosea and Shampine, Appl. Numer. Math. 20, 1996): second order,
/// L-stable, one-step. Both stages have the same h = g dt / 2 before f.
class TrBdf2 final : public Stepper {
 public:
  TrBdf2(const Model& model, const Assembler& assembler, LinearSolver& solver,
         const StepperOptions& options)
      : model_(model),
        stage_(model, assembler, solver, options.newton),
        force_(model, assembler),
        start_acceleration_(model.num_dofs()),
        middle_displacement_(model.num_dofs()),
        middle_velocities_(model.num_dofs()),
        past_displacement_(model.num_dofs()),
        past_velocities_(model.num_dofs()),
        velocities_(model.num_dofs()),
        end_positions_(model.num_dofs()),
        displacement_(model.num_dofs()) {}

  StepReport step(State& state, double dt) override {
    const double h = 0.5 * kGamma * dt;
    stage_.equation.inertia = 1.0 / (h * h);
    stage_.equation.velocity_factor = 1.0 / h;
    StepReport report = trapezoidal_stage(state, h);
    if (report.outcome != StepOutcome::Done) return report;
    // The weights of the three stages, also of their works; held degrees of freedom move evenly.
    constexpr double early = 0.5 / (2.0 - kGamma);
    constexpr double late = 1.0 - 2.0 * early;
    work_ = state.work;
    end_positions_ = state.positions;
    stage_.place_held_at(state, state.time + dt, end_positions_);
    stage_displacement(model_, state.positions, end_positions_, early, dt, state.velocities,
                       displacement_);
    force_.book(state.velocities, displacement_, work_);
    stage_displacement(model_, state.positions, end_positions_, early, dt, middle_velocities_,
                       displacement_);
    stage_.book(displacement_, work_);

    const StepReport second = bdf2_stage(state, h, dt);
    report.outcome = second.outcome;
    report.newton_iterations += second.newton_iterations;
    report.worst_dof = second.worst_dof;
    report.failure = second.failure;
    if (report.outcome != StepOutcome::Done) return report;

    velocities_ = (stage_.displacement() - past_displacement_) / h;
    stage_displacement(model_, state.positions, end_positions_, late, dt, velocities_,
                       displacement_);
    stage_.book(displacement_, work_);
    state.work = work_;
    state.accelerations = (velocities_ - past_velocities_) / h;
    stage_.finish(stage_.positions, velocities_, dt, state);
    return report;
  }

 private:
  static constexpr double kGamma = 0.58578643762690495;  // 2 - sqrt(2)

  StepReport trapezoidal_stage(const State& state, double h) {
    const double time = state.time + 2.0 * h;
    force_.acceleration(state, state.positions, state.velocities, state.time, 0.0,
                        start_acceleration_);
    Stage& equation = stage_.equation;
    equation.inertia_target = h * (2.0 * state.velocities + h * start_acceleration_);
    equation.velocity_reference = h * state.velocities;
    stage_.positions = state.positions + 2.0 * h * (state.velocities + h * start_acceleration_);
    stage_.place_held_at(state, time, stage_.positions);
    const StepReport report = stage_.solve(state, time);
    middle_displacement_ = stage_.displacement();
    middle_velocities_ = middle_displacement_ / h - state.velocities;
    return report;
  }

  StepReport bdf2_stage(const State& state, double h, double dt) {
    constexpr double middle = 1.0 / (kGamma * (2.0 - kGamma));
    constexpr double start = (1.0 - kGamma) * (1.0 - kGamma) / (kGamma * (2.0 - kGamma));
    past_displacement_ = middle * middle_displacement_;
    past_velocities_ = middle * middle_velocities_ - start * state.velocities;
    stage_.equation.inertia_target = past_displacement_ + h * past_velocities_;
    stage_.equation.velocity_reference = past_displacement_;
    const double rest = (1.0 - kGamma) * dt;
    stage_.positions =
        state.positions + middle_displacement_ + rest * middle_velocities_ +
        0.5 * rest * (rest / (kGamma * dt)) * (middle_velocities_ - state.velocities);
    stage_.place_held_at(state, state.time + dt, stage_.positions);
    return stage_.solve(state, state.time + dt);
  }

  const Model& model_;
  ImplicitStage stage_;
  ExplicitForce force_;
  Vector start_acceleration_;
  Vector middle_displacement_;
  Vector middle_velocities_;
  Vector past_displacement_;
  Vector past_velocities_;
  Vector velocities_;
  Vector end_positions_;  // of held degrees of freedom
  Vector displacement_;
  Work work_;
};

}  // namespace

std::unique_ptr<Stepper> make_tr_bdf2(const Model& model, const Assembler& assembler,
                                      LinearSolver& solver, const StepperOptions& options) {
  return std::make_unique<TrBdf2>(model, assembler, solver, options);
}

}  // namespace der
