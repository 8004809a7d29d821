#include "der/loads/loads.hpp"
#include "der/scenario/scenario.hpp"

namespace der {

Vector total_gravity(const scenario::Scene& scene) {
  Vector total = Vector::Zero(scene.dimension);
  for (const auto& load : scene.loads) {
    if (const auto* gravity = std::get_if<scenario::Gravity>(&load.what)) {
      total += Eigen::Map<const Vector>(gravity->acceleration.data(), scene.dimension);
    }
  }
  return total;
}

void add_load(const scenario::Gravity& load, const scenario::Scene& /*scene*/, Model& model) {
  for (Index i = 0; i < model.num_dofs(); ++i) {
    if (model.dofs[i].kind != DofKind::Position) continue;
    const auto component = static_cast<std::size_t>(model.dofs[i].component);
    model.gravity_force[i] += model.mass.lumped[i] * load.acceleration[component];
  }
}

}  // namespace der
