#include "der/core/index.hpp"
#include "der/loads/loads.hpp"
#include "der/scenario/scenario.hpp"

namespace der {

PresentGravity present_gravity(const scenario::Scene& scene, Model& model) {
  PresentGravity result{Vector::Zero(scene.dimension)};
  for (const auto& load : scene.loads) {
    const auto* gravity = std::get_if<scenario::Gravity>(&load.what);
    if (gravity == nullptr) continue;
    const scenario::VectorSeries& acceleration = gravity->acceleration;
    if (load.name.empty() && acceleration.constant()) {
      result.constant +=
          Eigen::Map<const Vector>(acceleration.values.front().data(), scene.dimension);
      continue;
    }
    for (std::size_t c = 0; c < to_size(scene.dimension); ++c) {
      Index& control = model.gravity_controls[c];
      if (control < 0) control = model.tables.add(component_of(acceleration, c));
    }
  }
  result.controls = model.gravity_controls;
  return result;
}

void add_load(const scenario::Gravity& /*load*/, const LoadContext& context, Model& model) {
  const auto [constant, controls] = present_gravity(context.scene, model);
  for (Index node = 0; node < model.num_nodes; ++node) {
    for (int c = 0; c < model.dimension; ++c) {
      const Index dof = model.dof(node, c);
      if (controls[to_size(c)] >= 0) {
        model.controlled_forces.push_back({dof, controls[to_size(c)], model.mass.lumped[dof]});
      } else {
        model.gravity_force[dof] += model.mass.lumped[dof] * constant[c];
      }
    }
  }
  if (!context.name.empty()) {
    model.named.push_back(vector_control(context.name, "m/s^2", controls));
  }
}

}  // namespace der
