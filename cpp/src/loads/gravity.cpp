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
  for (Index i = 0; i < model.num_dofs(); ++i) {
    if (model.dofs[i].kind != DofKind::Position) continue;
    const int component = model.dofs[i].component;
    if (controls[to_size(component)] >= 0) {
      model.controlled_forces.push_back({i, controls[to_size(component)], model.mass.lumped[i]});
    } else {
      model.gravity_force[i] += model.mass.lumped[i] * constant[component];
    }
  }
  if (!context.name.empty()) {
    model.named.push_back(vector_control(context.name, "m/s^2", controls));
  }
}

}  // namespace der
