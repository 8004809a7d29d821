#include <variant>

#include "der/steppers/explicit_force.hpp"
#include "der/steppers/implicit_stage.hpp"
#include "steppers/steppers.hpp"

namespace der {
namespace {

/// The two-step backward differentiation formula for steps of varying length (Hairer, Norsett and
/// Wanner, Solving Ordinary Differential Equations I, section III.5), for q and v alike: with
/// w = dt / previous dt and h = dt (1 + w)/(1 + 2 w),
///   y' = ((1 + w)^2 y - w^2 y_previous)/(1 + 2 w) + h f(y').
/// Second order, L-stable, little damping of slow motion. With no past yet w = 0: implicit Euler.
class Bdf2 final : public Stepper {
 public:
  Bdf2(const Model& model, const Assembler& assembler, LinearSolver& solver,
       const StepperOptions& options)
      : stage_(model, assembler, solver, options.newton, ImplicitStage::held_velocities(model)),
        force_(model, assembler),
        past_displacement_(model.num_dofs()),
        past_velocities_(model.num_dofs()),
        velocities_(model.num_dofs()) {}

  StepReport step(State& state, double dt) override {
    const auto* past = std::get_if<Bdf2Memory>(&state.memory);
    const double w = past != nullptr ? dt / state.last_step : 0.0;
    const double before = w * w / (1.0 + 2.0 * w);
    const double h = dt * (1.0 + w) / (1.0 + 2.0 * w);
    // The factors of y and y_previous above differ by 1.
    past_velocities_ = state.velocities;
    if (past != nullptr) {
      past_displacement_ = before * past->displacement;
      past_velocities_ += before * (state.velocities - past->velocities);
    } else {
      past_displacement_.setZero();
    }

    Stage& equation = stage_.equation;
    equation.inertia = 1.0 / (h * h);
    equation.inertia_target = past_displacement_ + h * past_velocities_;
    equation.velocity_factor = 1.0 / h;
    equation.velocity_reference = past_displacement_;
    stage_.here.coordinates =
        state.positions + dt * (state.velocities + 0.5 * dt * state.accelerations);
    stage_.apply_prescribed_motion_at(state, state.time + dt, stage_.here.coordinates);
    const StepReport report = stage_.solve(state, state.time + dt);
    if (report.outcome != StepOutcome::Done) return report;

    velocities_ = (stage_.displacement() - past_displacement_) / h;
    state.accelerations = (velocities_ - past_velocities_) / h;
    auto& memory = hold<Bdf2Memory>(state.memory);
    memory.displacement = stage_.displacement();
    memory.velocities = state.velocities;
    stage_.accumulate_and_finish(stage_.here.coordinates, velocities_, dt, 1.0, force_, state);
    return report;
  }

 private:
  ImplicitStage stage_;
  ExplicitForce force_;
  Vector past_displacement_;
  Vector past_velocities_;
  Vector velocities_;
};

}  // namespace

std::unique_ptr<Stepper> make_bdf2(const Model& model, const Assembler& assembler,
                                   LinearSolver& solver, const StepperOptions& options) {
  return std::make_unique<Bdf2>(model, assembler, solver, options);
}

}  // namespace der
