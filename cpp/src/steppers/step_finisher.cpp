#include "der/steppers/step_finisher.hpp"

#include "der/model/gravity.hpp"
#include "der/model/moment_place.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/steppers/work.hpp"

namespace der {

StepFinisher::StepFinisher(const Model& model)
    : model_(model),
      start_{Vector::Zero(model.num_dofs()), Vector::Zero(model.tables.size())},
      end_(start_) {}

void StepFinisher::finish(const Vector& positions, const Eigen::Ref<const Vector>& velocities,
                          double dt, State& state) {
  configuration_of(model_, state, start_);
  end_.coordinates = positions;
  evaluate_controls(model_, state, state.time + dt, end_.controls);
  const ControlWork work = control_work(model_, start_, end_);
  state.work.loads += work.loads;
  state.work.supports += work.supports;
  state.work.actuation += work.actuation;
  state.work.loads += cell_work(model_, start_, end_) + driven_gravity_energy(model_, end_) -
                      driven_gravity_energy(model_, start_);
  for (const HeldDof& held : model_.held) {
    const double before = state.velocities[held.dof];
    const double mean = (positions[held.dof] - state.positions[held.dof]) / dt;
    const double after = held_velocity(model_, state, held, state.time + dt, mean);
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
  follow(model_, state.positions, end_.controls, state.followed);
  state.last_step = dt;
}

}  // namespace der
