#include "output/spin_torque.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/loads/external_force.hpp"
#include "der/model/internal_damping.hpp"

namespace der {

SpinTorque::SpinTorque(const RodMesh& rod, const Model& model) {
  if (!model.has_sections()) return;
  for (const Clamp& clamp : rod.clamps) {
    if (!clamp.holds_section) continue;
    for (const Index edge : {rod.edge_before(clamp.place), rod.edge_after(clamp.place)}) {
      if (edge < 0) continue;
      const Index theta = model.framed_edges[to_size(rod.first_edge + edge)].theta;
      spun_.push_back(
          {edge, theta, ActingElements(model, [&](Index dof) { return dof == theta; })});
    }
  }
}

double SpinTorque::along(Index edge, const Model& model, const State& state) const {
  const auto spun = std::find_if(spun_.begin(), spun_.end(),
                                 [&](const Spun& other) { return other.edge == edge; });
  if (spun == spun_.end()) return 0.0;
  const Configuration here = configuration_of(model, state);
  Vector force;
  external_force(model, here, state.extra_force, force);
  add_circulatory_forces(model.elements->circulatory, here, 1.0, force);
  double torque = force[spun->theta] - model.damping[spun->theta] * state.velocities[spun->theta];
  const auto add = [&](auto, const auto&, const auto& dofs, const auto&, const auto& gradient) {
    const auto own = std::find(dofs.begin(), dofs.end(), spun->theta) - dofs.begin();
    torque -= gradient[own];
  };
  spun->elements.for_each_gradient(model, here, add);
  if (model.viscous) {
    Vector turn_rates;
    set_turn_rates(model, state, turn_rates);
    spun->elements.for_each_viscous_gradient(model, {here, state.velocities, turn_rates}, add);
  }
  return torque;
}

}  // namespace der
