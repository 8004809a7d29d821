#include "der/steppers/step_commit.hpp"

#include "der/model/gravity.hpp"
#include "der/model/internal_damping.hpp"
#include "der/model/moment_place.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/supports/clamp.hpp"

namespace der {

StepCommit::StepCommit(const Model& model, HeldVelocities held, LaggingRotations lagging)
    : model_(model),
      held_velocities_(held),
      rotations_(model),
      advances_rotations_(lagging == LaggingRotations::OfCommit && rotations_.any_lags()),
      controls_work_(any_clamp_turns(model) || !model.rest_lengths.empty() ||
                     model.natural_strain.is_actuated()),
      start_{Vector::Zero(model.num_dofs()), Vector::Zero(model.tables.size())},
      end_(start_),
      ahead_(start_),
      behind_(start_) {}

void StepCommit::finish(const Vector& positions, const Eigen::Ref<const Vector>& velocities,
                        double dt, State& state) {
  configuration_of(model_, state, start_);
  if (advances_rotations_) start_velocities_ = state.velocities;
  end_.coordinates = positions;
  evaluate_controls(model_, state, state.time + dt, end_.controls);
  const ControlWork work = follow_and_work(state);
  state.work.loads += work.loads;
  state.work.supports += work.supports;
  state.work.actuation += work.actuation;
  state.work.loads += cell_work(model_, start_, end_) + driven_gravity_energy(model_, end_) -
                      driven_gravity_energy(model_, start_);
  const bool drives = model_.viscous && any_clamp_turns(model_);
  const double power_before = drives ? driven_power(start_, state, dt, state.time) : 0.0;
  for (const HeldDof& held : model_.held) {
    const double before = state.velocities[held.dof];
    const double mean = (positions[held.dof] - state.positions[held.dof]) / dt;
    const double after = held_velocities_ == HeldVelocities::OfScheme
                             ? velocities[held.dof]
                             : held_velocity(model_, state, held, state.time + dt, mean);
    const double drag = model_.damping[held.dof] * mean * mean * dt;
    state.work.drag += drag;
    state.work.supports +=
        drag + 0.5 * model_.mass.lumped[held.dof] * (after * after - before * before);
    state.velocities[held.dof] = after;
    state.positions[held.dof] = positions[held.dof];
  }
  for (const Index dof : model_.dofs.free()) {
    state.velocities[dof] = velocities[dof];
    state.positions[dof] = positions[dof];
  }
  move_rotations(dt, state);
  if (drives) {
    // Clamps work against the viscous loads beside them, which take that up.
    const double power = driven_power(end_, state, dt, state.time + dt);
    const double taken = 0.5 * dt * (power_before + power);
    state.work.supports += taken;
    state.work.drag += taken;
  }
  state.last_step = dt;
}

/// A scheme can only guess rotations that the places of nodes determine. Their mean rate is the
/// guess for the next step.
void StepCommit::move_rotations(double dt, State& state) {
  if (!model_.has_rotations()) return;
  if (advances_rotations_) {
    const JointRotations::Works works = rotations_.advance(
        {state, start_.coordinates, start_velocities_, dt}, state.positions, state.velocities);
    state.work.loads += works.loads;
    state.work.drag += works.drag;
  } else {
    state.work.loads += rotations_.settle(end_.controls, state.extra_force, state.positions,
                                          JointRotations::Which::Undamped);
    if (model_.has_sections()) follow(model_, state.positions, end_.controls, state.followed);
    end_.coordinates = state.positions;
    rotations_.set_rates(end_, state.extra_force, state.velocities);
  }
  for (Index i = 0; i < model_.dofs.num_rotations(); ++i) {
    const Index dof = model_.dofs.rotation(i);
    if (!model_.dofs.is_free(dof)) continue;
    state.accelerations[dof] = 0.0;
    if (rotations_.lags(i)) continue;
    state.velocities[dof] = (state.positions[dof] - start_.coordinates[dof]) / dt;
  }
}

/// At one end of the step of `dt` [s] from `state.time`.
double StepCommit::driven_power(const Configuration& here, const State& state, double dt,
                                double time) {
  set_turn_rates(model_, state, state.time, state.time + dt, time, turn_rates_);
  return driven_viscous_power(model_, {here, state.velocities, turn_rates_});
}

/// Moves what `state` follows to the end of the step, and returns the works of its controls: the
/// mean of those of their whole change at the start and at the end. There each has the frames of
/// its own place. Seen from the frames of the start, the edge that a clamp moves at the end turns
/// its section by the transport from there, which is not a turn of the clamp: the spin of
/// sections takes that up (model/spin.hpp). Its work with the edge's torque is of the second order
/// in each step.
ControlWork StepCommit::follow_and_work(State& state) {
  if (controls_work_) {
    ahead_.coordinates = start_.coordinates;
    ahead_.controls = end_.controls;
  }
  follow(model_, end_.coordinates, end_.controls, state.followed);
  enter_followed(model_, state.followed, end_.controls);
  if (!controls_work_) return {};
  behind_.coordinates = end_.coordinates;
  evaluate_controls(model_, state, state.time, behind_.controls);
  const ControlWork first = control_work(model_, start_, ahead_);
  const ControlWork last = control_work(model_, behind_, end_);
  return {0.5 * (first.supports + last.supports), 0.5 * (first.actuation + last.actuation),
          0.5 * (first.loads + last.loads)};
}

}  // namespace der
