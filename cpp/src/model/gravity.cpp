#include "der/model/gravity.hpp"

#include "der/core/index.hpp"
#include "der/core/sum_of.hpp"
#include "der/model/model.hpp"

namespace der {

double gravity_energy(const Model& model, const Configuration& here) {
  const double driven = driven_gravity_energy(model, here);
  if (!model.load_variation) {
    return driven - sum_of<double>(model.num_dofs(), [&](Index dof) {
             return model.gravity_force[dof] * here.coordinates[dof];
           });
  }
  return driven - model.load_variation->gravity_force.at(here.load_factor).dot(here.coordinates);
}

double driven_gravity_energy(const Model& model, const Configuration& here) {
  return driven_gravity_energy(model, model.mass.lumped, here);
}

double driven_gravity_energy(const Model& model, const Vector& masses, const Configuration& here) {
  if (model.gravity_controls[0] < 0) return 0.0;
  double energy = 0.0;
  for (Index dof = 0; dof < model.dofs.num_positions(); ++dof) {
    const Index control = model.gravity_controls[to_size(model.dofs[dof].component)];
    energy -= masses[dof] * here.controls[control] * here.coordinates[dof];
  }
  return energy;
}

}  // namespace der
