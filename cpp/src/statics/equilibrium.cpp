#include "der/statics/equilibrium.hpp"

#include "der/loads/loads.hpp"
#include "der/supports/supports.hpp"

namespace der {
namespace {

constexpr int kMaxRelaxations = 400;
/// A structure that has moved this many times its size is held by nothing.
constexpr double kDrift = 100.0;

/// Number of negative eigenvalues of the stiffness at a solution.
Index unstable_directions(const Model& model, const Assembler& assembler, LinearSolver& solver,
                          const Vector& controls, const Vector& positions) {
  Vector gradient(model.num_dofs());
  Vector values(assembler.num_values());
  assembler.gradient_and_hessian(positions, controls, gradient, values);
  return solver.factorize(values).negative_pivots;
}

}  // namespace

EquilibriumReport find_equilibrium(const Model& model, const Assembler& assembler,
                                   LinearSolver& solver, const NewtonOptions& options,
                                   const State& state, Vector& positions) {
  Stage stage(model);
  stage.mass = {Vector::Ones(model.num_dofs()), {}};
  model.controls.evaluate(state.time, stage.controls);
  external_force(model, stage.controls, state.extra_force, stage.force);
  place_held(model, stage.controls, positions);
  Newton newton(model, assembler, solver, options);

  EquilibriumReport result;
  const Vector start = positions;
  bool drifted = false;
  const auto attempt = [&] {
    const NewtonReport report = newton.solve(stage, positions);
    result.newton_iterations += report.iterations;
    result.residual = report.residual;
    result.force_scale = report.force_scale;
    result.failure = report.failure;
    drifted = (positions - start).lpNorm<Eigen::Infinity>() > kDrift * model.size;
    if (drifted) result.failure = "the structure drifts away: nothing holds it";
    return report.converged && !drifted;
  };

  result.converged = attempt();
  // `inertia` is the inverse of the pseudo-time step. It starts where the unbalanced force alone
  // would move a node by the size of the structure.
  double resistance = result.force_scale / model.size;
  while (!result.converged && !drifted && result.relaxations < kMaxRelaxations) {
    ++result.relaxations;
    stage.inertia = resistance;
    stage.inertia_target = positions;
    const bool moved = attempt();
    resistance *= moved ? 0.25 : 4.0;
    if (!moved) continue;
    stage.inertia = 0.0;
    result.converged = attempt();
  }
  if (result.converged) {
    result.failure.clear();
    result.negative_pivots =
        unstable_directions(model, assembler, solver, stage.controls, positions);
  }
  return result;
}

}  // namespace der
