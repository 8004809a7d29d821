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

StepReport ImplicitStage::solve(const State& state, double time) {
  model_.controls.evaluate(time, equation.controls);
  external_force(model_, equation.controls, state.extra_force, equation.force);
  place_held(model_, equation.controls, positions);
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

}  // namespace der
