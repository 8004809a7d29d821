#include "der/steppers/implicit_stage.hpp"

#include "der/loads/loads.hpp"
#include "der/steppers/work.hpp"
#include "der/supports/supports.hpp"

namespace der {

ImplicitStage::ImplicitStage(const Model& model, const Assembler& assembler, LinearSolver& solver,
                             const NewtonOptions& options)
    : equation(model),
      positions(Vector::Zero(model.num_dofs())),
      model_(model),
      newton_(model, assembler, solver, options),
      finisher_(model),
      displacement_(Vector::Zero(model.num_dofs())) {}

void ImplicitStage::place_held_at(const State& state, double time, Vector& where) {
  model_.controls.evaluate(time, state.ramps, equation.controls);
  place_held(model_, equation.controls, where);
}

StepReport ImplicitStage::solve(const State& state, double time) {
  model_.controls.evaluate(time, state.ramps, equation.controls);
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

void ImplicitStage::book(const Vector& displacement, Work& work) const {
  const Vector& residual = newton_.residual();
  work.loads += displacement.dot(equation.force - model_.gravity_force) +
                moment_work(model_, positions, equation.controls, displacement);
  if (model_.damped) {
    work.drag +=
        equation.velocity_factor *
        displacement.dot(model_.damping.cwiseProduct(positions - equation.velocity_reference));
  }
  for (const Index dof : model_.free_dofs) work.solver += displacement[dof] * residual[dof];
  for (const HeldDof& held : model_.held) {
    // Without the inertia that the scheme gives the held mass; `finish` has its energy.
    const double inertial = equation.inertia * equation.mass.lumped[held.dof] *
                            (positions[held.dof] - equation.inertia_target[held.dof]);
    work.supports += displacement[held.dof] * (residual[held.dof] - inertial);
  }
}

void ImplicitStage::book_and_finish(const Vector& new_positions,
                                    const Eigen::Ref<const Vector>& new_velocities, double dt,
                                    State& state) {
  displacement_ = new_positions - state.positions;
  book(displacement_, state.work);
  finisher_.finish(new_positions, new_velocities, dt, state);
}

}  // namespace der
