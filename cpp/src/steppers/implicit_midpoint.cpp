#include "der/steppers/implicit_stage.hpp"
#include "steppers.hpp"

namespace der {
namespace {

/// M (v' - v)/dt = F((q + q')/2, (v + v')/2, t + dt/2), (q' - q)/dt = (v + v')/2: second order,
/// A-stable, symplectic; keeps linear and angular momentum and does not damp (Hairer, Lubich and
/// Wanner, Geometric Numerical Integration, section II.1). The unknown is y = (q + q')/2.
class ImplicitMidpoint final : public Stepper {
 public:
  ImplicitMidpoint(const Model& model, const Assembler& assembler, LinearSolver& solver,
                   const StepperOptions& options)
      : stage_(model, assembler, solver, options.newton),
        positions_(model.num_dofs()),
        velocities_(model.num_dofs()) {}

  StepReport step(State& state, double dt) override {
    const double half = 0.5 * dt;
    Stage& equation = stage_.equation;
    equation.inertia = 1.0 / (half * half);
    equation.inertia_target = half * state.velocities;
    equation.velocity_factor = 1.0 / half;

    // Held degrees of freedom end the step where their table says, so their midpoint is the mean.
    positions_ = state.positions + dt * (state.velocities + half * state.accelerations);
    stage_.place_held_at(state, state.time + dt, positions_);
    stage_.positions = 0.5 * (state.positions + positions_);
    const StepReport report = stage_.solve(state, state.time + half);
    if (report.outcome != StepOutcome::Done) return report;

    positions_ = state.positions + 2.0 * stage_.displacement();
    velocities_ = (2.0 / half) * stage_.displacement() - state.velocities;
    stage_.place_held_at(state, state.time + dt, positions_);
    state.accelerations = (velocities_ - state.velocities) / dt;
    stage_.book_and_finish(positions_, velocities_, dt, state);
    return report;
  }

 private:
  ImplicitStage stage_;
  Vector positions_;
  Vector velocities_;
};

}  // namespace

std::unique_ptr<Stepper> make_implicit_midpoint(const Model& model, const Assembler& assembler,
                                                LinearSolver& solver,
                                                const StepperOptions& options) {
  return std::make_unique<ImplicitMidpoint>(model, assembler, solver, options);
}

}  // namespace der
