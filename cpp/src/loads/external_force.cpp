#include "der/loads/external_force.hpp"

namespace der {

void external_force(const Model& model, const Vector& controls, const Vector& extra,
                    Vector& force) {
  force = model.gravity_force + model.dead_force + extra;
  for (const ControlledForce& f : model.controlled_forces) {
    force[f.dof] += f.weight * controls[f.control];
  }
}

}  // namespace der
