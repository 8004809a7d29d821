#include "der/model/prescribed_motion.hpp"

namespace der {

void apply_prescribed_motion(const Model& model, const Vector& controls, Vector& positions) {
  for (const HeldDof& held : model.held) {
    positions[held.dof] =
        model.initial_positions[held.dof] +
        (held.displacement >= 0 ? held.weight * controls[held.displacement] : 0.0);
  }
}

double control_rate(const Model& model, const State& state, Index control, double time,
                    double mean) {
  if (model.load_variation || find_ramp(state, control) != nullptr) return mean;
  const scenario::Series& table = model.tables[control];
  return table.course.kind == scenario::Course::Kind::Linear ? mean : slope_at(table, time);
}

double held_velocity(const Model& model, const State& state, const HeldDof& held, double time,
                     double mean) {
  if (held.displacement < 0) return mean;
  return held.weight * control_rate(model, state, held.displacement, time, mean / held.weight);
}

void velocities_in_step(const Model& model, const State& state, const Vector& end, double dt,
                        double time, Vector& velocities) {
  velocities = state.velocities;
  for (const HeldDof& held : model.held) {
    const double mean = (end[held.dof] - state.positions[held.dof]) / dt;
    velocities[held.dof] = held_velocity(model, state, held, time, mean);
  }
}

}  // namespace der
