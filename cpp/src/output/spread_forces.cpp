#include "output/spread_forces.hpp"

#include <utility>

#include "der/core/index.hpp"
#include "der/energies/circulatory_load.hpp"

namespace der {

SpreadForces::SpreadForces(const RodMesh& rod, const Model& model)
    : dimension_(model.dimension), rod_(rod) {
  for (const Index node : rod.nodes) first_dofs_.push_back(model.dof(node, 0));
  for (const ForcePlace& place : rod.force_places) {
    const std::vector<Weighted> nodes = node_weights(rod, place.arc_length, model);
    if (nodes.size() == 1) continue;
    for (const Index turns : turns_of(rod)) {
      Force& force = forces_.emplace_back(Force{place, nodes});
      force.place.arc_length += turns * rod.rest_length();
      for (Weighted& node : force.nodes) node.place += turns * static_cast<Index>(rod.nodes.size());
    }
  }
}

Vec3 SpreadForces::node_point(Index node, const State& state) const {
  const Index first = first_dofs_[to_size(rod_.position(node))];
  Vec3 point = Vec3::Zero();
  for (int c = 0; c < dimension_; ++c) point[c] = state.positions[first + c];
  return point;
}

Vec3 SpreadForces::point(std::size_t i, const State& state) const {
  Vec3 point = Vec3::Zero();
  for (const auto& [node, weight] : forces_[i].nodes) point += weight * node_point(node, state);
  return point;
}

Vec3 SpreadForces::value(std::size_t i, const Model& model, const State& state) const {
  const ForcePlace& place = forces_[i].place;
  Vec3 value = -place.stiffness.cwiseProduct(point(i, state) - place.anchor);
  if (place.follower >= 0) {
    const CirculatoryLoad& load = circulatory_loads(*model.elements)[to_size(place.follower)];
    value += load.force(configuration_of(model, state));
  }
  for (int c = 0; c < dimension_; ++c) {
    const Index control = place.force[to_size(c)];
    if (control >= 0) value[c] += control_value(model, state, control);
  }
  return value;
}

}  // namespace der
