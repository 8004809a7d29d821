#include "der/loads/loads.hpp"

namespace der {

void external_force(const Model& model, double load_factor, const Vector& controls,
                    const Vector& extra, Vector& force) {
  if (const auto& varied = model.load_variation) {
    force = varied->gravity_force.at(load_factor) + varied->dead_force.at(load_factor) + extra;
  } else {
    force = model.gravity_force + model.dead_force + extra;
  }
  for (const ControlledForce& f : model.controlled_forces) {
    force[f.dof] += f.weight * controls[f.control];
  }
}

}  // namespace der
