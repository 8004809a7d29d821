#include <cmath>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/loads/loads.hpp"

namespace der {

// Stokes drag on a sphere and the weight of the fluid that it displaces (Batchelor, An Introduction
// to Fluid Dynamics, eq. 4.9.19).
void add_load(const scenario::Fluid& load, const LoadContext& context, Model& model) {
  const auto [gravity, controls] = present_gravity(context.scene, model);
  for (const RodMesh& rod : model.rods) {
    for (std::size_t i = 0; i < rod.nodes.size(); ++i) {
      const double radius = rod.sphere_radius[i];
      const double drag = 6.0 * kPi * load.viscosity * radius;
      const double displaced = 4.0 / 3.0 * kPi * std::pow(radius, 3) * load.density;
      for (int c = 0; c < model.dimension; ++c) {
        const Index dof = model.dof(rod.nodes[i], c);
        model.damping[dof] += drag;
        model.dead_force[dof] -= displaced * gravity[c];
        const Index control = controls[to_size(c)];
        if (control >= 0) model.controlled_forces.push_back({dof, control, -displaced});
      }
    }
  }
}

}  // namespace der
