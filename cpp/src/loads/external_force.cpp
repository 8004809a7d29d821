#include "der/loads/external_force.hpp"

namespace der {

void external_force(const Model& model, const Configuration& here, const Vector& extra,
                    Vector& force) {
  if (const auto& varied = model.load_variation) {
    force = varied->gravity_force.at(here.load_factor) + varied->dead_force.at(here.load_factor) +
            extra;
  } else {
    force = model.gravity_force + model.dead_force + extra;
  }
  for (const ControlledForce& f : model.controlled_forces) {
    force[f.dof] += f.weight * here.controls[f.control];
  }
}

}  // namespace der
