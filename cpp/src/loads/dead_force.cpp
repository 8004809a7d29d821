#include "der/loads/dead_force.hpp"

namespace der {

DeadForce::DeadForce(const scenario::VectorSeries& force, bool is_set, Model& model) {
  if (force.constant() && !is_set) {
    constant_ = force.values.front();
    return;
  }
  for (std::size_t c = 0; c < static_cast<std::size_t>(model.dimension); ++c) {
    controls_.push_back(model.tables.add(component_of(force, c)));
  }
}

void DeadForce::act_on(Index node, double weight, Model& model) const {
  for (int c = 0; c < model.dimension; ++c) {
    const auto component = static_cast<std::size_t>(c);
    const Index dof = model.dof(node, c);
    if (controls_.empty()) {
      model.dead_force[dof] += weight * constant_[component];
    } else {
      model.controlled_forces.push_back({dof, controls_[component], weight});
    }
  }
}

std::array<Index, 3> DeadForce::as_controls(Model& model) const {
  std::array<Index, 3> controls{-1, -1, -1};
  for (std::size_t c = 0; c < static_cast<std::size_t>(model.dimension); ++c) {
    controls[c] = controls_.empty() ? model.tables.add({{0.0}, {constant_[c]}}) : controls_[c];
  }
  return controls;
}

}  // namespace der
