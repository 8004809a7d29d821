#include "der/assembly/discrete_gradient_assembler.hpp"
#include "der/steppers/implicit_stage.hpp"
#include "steppers/predictor.hpp"
#include "steppers/steppers.hpp"

namespace der {
namespace {

/// The energy-momentum method (Simo and Tarnow, ZAMP 43, 1992; Gonzalez, J. Nonlinear Sci. 6,
/// 1996): the kinematics of the implicit midpoint rule with discrete gradients of the energy,
///   M (v' - v)/dt = -D(q, q') + f(t + dt/2) - C (v + v')/2, (q' - q)/dt = (v + v')/2.
/// Second order; keeps the energy, linear and angular momentum, however large the rotations of a
/// step, to what Newton's method leaves. The unknown is y = (q + q')/2.
class EnergyMomentum final : public Stepper {
 public:
  EnergyMomentum(const Model& model, const Assembler& assembler, LinearSolver& solver,
                 const StepperOptions& options)
      : model_(model),
        guess_(model),
        stage_(model, assembler, solver, options.newton, ImplicitStage::held_velocities(model)),
        gradient_(model, assembler),
        positions_(model.num_dofs()),
        velocities_(model.num_dofs()) {
    stage_.equation.discrete_gradient = &gradient_;
  }

  StepReport step(State& state, double dt) override {
    const double half = 0.5 * dt;
    Stage& equation = stage_.equation;
    equation.inertia = 1.0 / (half * half);
    equation.inertia_target = half * state.velocities;
    equation.velocity_factor = 1.0 / half;
    configuration_of(model_, state, gradient_.start);
    evaluate_controls(model_, state, state.time + dt, gradient_.end.controls);

    stage_.controls().begin_step(state, dt);
    stage_.controls().enter_stage(0);
    guess_.evaluate(state, dt, positions_);
    stage_.apply_prescribed_motion_at(state, state.time + dt, positions_);
    stage_.here.coordinates = 0.5 * (state.positions + positions_);
    const StepReport report = stage_.solve(state, state.time + half);
    if (report.outcome != StepOutcome::Done) return report;

    positions_ = state.positions + 2.0 * stage_.displacement();
    velocities_ = (2.0 / half) * stage_.displacement() - state.velocities;
    stage_.apply_prescribed_motion_at(state, state.time + dt, positions_);
    state.accelerations = (velocities_ - state.velocities) / dt;
    state.work.supports += gradient_.work_at_pivots(stage_.here);
    stage_.accumulate_and_finish(positions_, velocities_, dt, state);
    return report;
  }

 private:
  const Model& model_;
  Predictor guess_;
  ImplicitStage stage_;
  DiscreteGradientAssembler gradient_;
  Vector positions_;
  Vector velocities_;
};

}  // namespace

std::unique_ptr<Stepper> make_energy_momentum(const Model& model, const Assembler& assembler,
                                              LinearSolver& solver, const StepperOptions& options) {
  return std::make_unique<EnergyMomentum>(model, assembler, solver, options);
}

}  // namespace der
