#include "der/steppers/implicit_stage.hpp"

#include "der/loads/loads.hpp"
#include "der/supports/supports.hpp"

namespace der {

ImplicitStage::ImplicitStage(const Model& model, const Assembler& assembler, LinearSolver& solver,
                             const NewtonOptions& options)
    : equation(model),
      positions(Vector::Zero(model.num_dofs())),
      model_(model),
      newton_(model, assembler, solver, options) {}

void ImplicitStage::place_held_at(double time, Vector& where) {
  model_.controls.evaluate(time, equation.controls);
  place_held(model_, equation.controls, where);
}

StepReport ImplicitStage::solve(const State& state, double time) {
  model_.controls.evaluate(time, equation.controls);
  external_force(model_, equation.controls, state.extra_force, equation.force);
  const NewtonReport newton = newton_.solve(equation, positions);
  StepReport report;
  report.newton_iterations = newton.iterations;
  if (!newton.converged) {
    report.outcome = StepOutcome::NotConverged;
    report.worst_dof = newton.worst_dof;
    report.failure = newton.failure;
  }
  return report;
}

void ImplicitStage::finish(const Vector& new_positions, const Vector& new_velocities, double dt,
                           State& state) const {
  for (const Index dof : model_.free_dofs) {
    state.velocities[dof] = new_velocities[dof];
    state.positions[dof] = new_positions[dof];
  }
  for (const HeldDof& held : model_.held) {
    state.velocities[held.dof] = (new_positions[held.dof] - state.positions[held.dof]) / dt;
    state.positions[held.dof] = new_positions[held.dof];
  }
  state.last_step = dt;
}

}  // namespace der
