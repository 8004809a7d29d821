#include "der/steppers/dense_output.hpp"

#include "der/kinematics/hermite.hpp"
#include "der/model/gravity.hpp"
#include "der/model/internal_damping.hpp"
#include "der/model/moment_place.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/steppers/work.hpp"

namespace der {

DenseOutput::DenseOutput(const Model& model, const Assembler& assembler)
    : model_(model),
      force_(model, assembler),
      rotations_(model),
      velocities_(Vector::Zero(model.num_dofs())),
      controls_(Vector::Zero(model.tables.size())),
      before_{Vector::Zero(model.num_dofs()), controls_},
      after_(before_) {}

void DenseOutput::evaluate(double time, const State& start, const State& end, State& result) {
  const double h = end.time - start.time;
  const Hermite weight((time - start.time) / h, h);
  result = end;
  result.time = time;
  result.positions = weight.value(start.positions, end.positions, start.velocities, end.velocities);
  result.velocities = weight.rate(start.positions, end.positions, start.velocities, end.velocities);
  evaluate_controls(model_, end, time, controls_);
  apply_prescribed_motion(model_, controls_, result.positions);
  if (model_.has_sections()) follow(model_, result);
  rotations_.settle(controls_, end.extra_force, result.positions, JointRotations::Which::Undamped);
  if (model_.has_sections() && model_.has_rotations()) follow(model_, result);

  Work work_start = start.work;
  for (const HeldDof& held : model_.held) {
    const double mean = end.velocities[held.dof];  // but of tables without kinks
    const double before = start.velocities[held.dof];
    const double after = held_velocity(model_, start, held, start.time, mean);
    result.velocities[held.dof] = held_velocity(model_, end, held, time, mean);
    work_start.supports += 0.5 * model_.mass.lumped[held.dof] * (after * after - before * before);
  }
  const Work power_start = powers(start, start, end);
  const Work power_end = powers(end, start, end);
  for (double Work::* part :
       {&Work::loads, &Work::supports, &Work::actuation, &Work::drag, &Work::solver}) {
    result.work.*part =
        weight.value(work_start.*part, end.work.*part, power_start.*part, power_end.*part);
  }
}

Work DenseOutput::powers(const State& where, const State& start, const State& end) {
  Work power;
  power.solver = (end.work.solver - start.work.solver) / (end.time - start.time);
  add_table_powers(where, start, end, power);
  velocities_ = where.velocities;
  for (const HeldDof& held : model_.held) {
    const double velocity =
        held_velocity(model_, where, held, where.time, end.velocities[held.dof]);
    const double drag = model_.damping[held.dof] * velocity * velocity;
    velocities_[held.dof] = velocity;
    power.drag += drag;
    power.supports += drag;
  }
  force_.evaluate_works(start, where.positions, velocities_, where.time);
  force_.accumulate(velocities_, velocities_, power);
  evaluate_controls(model_, end, where.time, before_.controls);
  if (model_.viscous) {
    before_.coordinates = where.positions;
    set_turn_rates(model_, where, start.time, end.time, where.time, turn_rates_);
    const double driven = driven_viscous_power(model_, {before_, velocities_, turn_rates_});
    power.supports += driven;
    power.drag += driven;
  }
  before_.coordinates = velocities_;
  power.loads += driven_gravity_energy(model_, before_);
  return power;
}

/// By a central difference over the length of the step.
void DenseOutput::add_table_powers(const State& where, const State& start, const State& end,
                                   Work& power) {
  evaluate_controls(model_, end, start.time, before_.controls);
  evaluate_controls(model_, end, end.time, after_.controls);
  controls_ = 0.5 * (after_.controls - before_.controls);
  evaluate_controls(model_, end, where.time, before_.controls);
  enter_followed(model_, where.followed, before_.controls);  // as at the ends of steps
  after_.controls = before_.controls + controls_;
  before_.controls -= controls_;
  const double dt = end.time - start.time;
  before_.coordinates = where.positions;
  after_.coordinates = where.positions;
  const ControlWork work = control_work(model_, before_, after_);
  power.loads += work.loads / dt;
  power.supports += work.supports / dt;
  power.actuation += work.actuation / dt;
  power.loads +=
      (driven_gravity_energy(model_, after_) - driven_gravity_energy(model_, before_)) / dt;
  before_.coordinates = start.positions;
  after_.coordinates = end.positions;
  power.loads += cell_work(model_, before_, after_) / dt;
}

}  // namespace der
