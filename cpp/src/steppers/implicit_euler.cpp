#include "der/steppers/implicit_stage.hpp"
#include "steppers.hpp"

namespace der {
namespace {

/// q' = q + dt v', M (v' - v)/dt = F(q', v', t + dt): first order, L-stable, damps motion away.
class ImplicitEuler final : public Stepper {
 public:
  ImplicitEuler(const Model& model, const Assembler& assembler, LinearSolver& solver,
                const StepperOptions& options)
      : stage_(model, assembler, solver, options.newton), velocities_(model.num_dofs()) {}

  StepReport step(State& state, double dt) override {
    Stage& equation = stage_.equation;
    equation.inertia = 1.0 / (dt * dt);
    equation.inertia_target = dt * state.velocities;
    equation.velocity_factor = 1.0 / dt;
    stage_.positions = state.positions + dt * (state.velocities + dt * state.accelerations);
    stage_.place_held_at(state, state.time + dt, stage_.positions);
    const StepReport report = stage_.solve(state, state.time + dt);
    if (report.outcome != StepOutcome::Done) return report;

    velocities_ = stage_.displacement() / dt;
    state.accelerations = (velocities_ - state.velocities) / dt;
    stage_.book_and_finish(stage_.positions, velocities_, dt, state);
    return report;
  }

 private:
  ImplicitStage stage_;
  Vector velocities_;
};

}  // namespace

std::unique_ptr<Stepper> make_implicit_euler(const Model& model, const Assembler& assembler,
                                             LinearSolver& solver, const StepperOptions& options) {
  return std::make_unique<ImplicitEuler>(model, assembler, solver, options);
}

}  // namespace der
