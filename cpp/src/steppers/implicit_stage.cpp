#include "der/steppers/implicit_stage.hpp"

#include <algorithm>
#include <vector>

#include "der/assembly/discrete_gradient_assembler.hpp"
#include "der/core/index.hpp"
#include "der/core/sum_of.hpp"
#include "der/loads/external_force.hpp"
#include "der/model/internal_damping.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/steppers/work.hpp"

namespace der {
namespace {

/// Share of the gyroscopic forces from which on they may be why Newton's method fails.
constexpr double kLargeGyroscopicShare = 0.3;

}  // namespace

ImplicitStage::ImplicitStage(const Model& model, const Assembler& assembler, LinearSolver& solver,
                             const NewtonOptions& options, StepCommit::HeldVelocities held,
                             StepCommit::LaggingRotations lagging)
    : equation(model),
      here{Vector::Zero(model.num_dofs()), Vector::Zero(model.tables.size())},
      model_(model),
      problem_(model, assembler, model.mass),
      newton_(model.dofs, solver, assembler.num_values(), options),
      finisher_(model, held, lagging),
      controls_(model),
      held_controls_(Vector::Zero(model.tables.size())),
      displacement_(Vector::Zero(model.num_dofs())),
      start_velocities_(Vector::Zero(model.num_dofs())) {
  equation.is_motion = true;
}

void ImplicitStage::apply_prescribed_motion_at(const State& state, double time, Vector& where) {
  controls_.evaluate(state, time, held_controls_);
  apply_prescribed_motion(model_, held_controls_, where);
}

StepReport ImplicitStage::solve(const State& state, double time) {
  here.load_factor = state.load_factor;
  controls_.evaluate(state, time, here.controls);
  external_force(model_, here, state.extra_force, equation.force);
  if (model_.viscous) {
    set_turn_rates(model_, state, state.time, time, time, equation.turn_rates);
  }
  equation.origin = state.positions;
  problem_.pose(equation, here);
  const NewtonReport newton = newton_.solve(problem_);
  StepReport report;
  report.newton_iterations = newton.iterations;
  if (!newton.converged) {
    report.outcome = StepOutcome::NotConverged;
    report.worst_dof = newton.worst_dof;
    report.failure = newton.failure;
    if (problem_.gyroscopic_share() > kLargeGyroscopicShare) {
      report.failure += "; sections spin so fast that gyroscopic forces rule the motion of nodes";
    }
    return report;
  }
  report = check_turns(model_, state, here.coordinates, here.controls);
  report.newton_iterations = newton.iterations;
  return report;
}

void ImplicitStage::accumulate(const Vector& displacement, Work& work) {
  accumulate_forces(displacement, work);
  accumulate_solver(displacement, work);
}

void ImplicitStage::accumulate_forces(const Vector& displacement, Work& work) {
  const Vector& moved = newton_.displacement();
  const auto size = static_cast<Index>(displacement.size());
  work.loads +=
      sum_of<double>(size,
                     [&](Index i) {
                       return displacement[i] * (equation.force[i] - model_.gravity_force[i]);
                     }) +
      moments(displacement);
  if (model_.damped) {
    work.drag += equation.velocity_factor * sum_of<double>(size, [&](Index i) {
                   return displacement[i] *
                          (model_.damping[i] * (moved[i] - equation.velocity_reference[i]));
                 });
  }
  if (model_.viscous) {
    viscous_.setZero(model_.num_dofs());
    velocities_ = equation.velocity_factor * (moved - equation.velocity_reference);
    add_viscous_forces(model_, {here, velocities_, equation.turn_rates}, viscous_);
    work.drag += displacement.dot(viscous_);
  }
  for (const HeldDof& held : model_.held) {
    // Without the inertia and the drag that the scheme gives the held node; `finish` has them.
    const double inertial = equation.inertia * model_.mass.lumped[held.dof] *
                            (moved[held.dof] - equation.inertia_target[held.dof]);
    const double drag = equation.velocity_factor * model_.damping[held.dof] *
                        (moved[held.dof] - equation.velocity_reference[held.dof]);
    work.drag -= displacement[held.dof] * drag;
    work.supports += displacement[held.dof] * (newton_.residual()[held.dof] - inertial - drag);
  }
}

double ImplicitStage::moments(const Vector& displacement) const {
  if (equation.discrete_gradient == nullptr) {
    return moment_work(model_, here, displacement);
  }
  return equation.discrete_gradient->moment_work(here, displacement);
}

void ImplicitStage::accumulate_solver(const Vector& displacement, Work& work) const {
  const Vector& residual = newton_.residual();
  const std::vector<Index>& free = model_.dofs.free();
  work.solver += sum_of<double>(model_.num_free(), [&](Index i) {
    const Index dof = free[to_size(i)];
    return displacement[dof] * residual[dof];
  });
}

void ImplicitStage::accumulate_and_finish(const Vector& new_positions,
                                          const Eigen::Ref<const Vector>& new_velocities, double dt,
                                          State& state) {
  displacement_ = new_positions - state.positions;
  accumulate(displacement_, state.work);
  finisher_.finish(new_positions, new_velocities, dt, state);
}

void ImplicitStage::accumulate_and_finish(const Vector& new_positions,
                                          const Eigen::Ref<const Vector>& new_velocities, double dt,
                                          double place, ExplicitForce& at_start, State& state) {
  // The rule with points at 0 and `place` that is exact for a power linear in time.
  const double late = 0.5 / place;
  displacement_ = (1.0 - late) * (new_positions - state.positions);
  if (finisher_.held_velocities() == StepCommit::HeldVelocities::OfScheme) {
    start_velocities_ = state.velocities;
  } else {
    velocities_in_step(model_, state, new_positions, dt, state.time, start_velocities_);
  }
  at_start.evaluate_works(state, state.positions, start_velocities_, state.time);
  at_start.accumulate(start_velocities_, displacement_, state.work);
  displacement_ = late * (new_positions - state.positions);
  accumulate_forces(displacement_, state.work);
  // The solver leaves a residual in stages only, none at the start of the step.
  displacement_ = new_positions - state.positions;
  accumulate_solver(displacement_, state.work);
  finisher_.finish(new_positions, new_velocities, dt, state);
}

}  // namespace der
