#include "der/core/index.hpp"
#include "der/energies/registry.hpp"
#include "der/loads/circulatory.hpp"
#include "der/loads/dead_force.hpp"
#include "der/loads/loads.hpp"
#include "der/model/location.hpp"

namespace der {

void add_load(const scenario::PointForce& load, const LoadContext& context, Model& model) {
  RodMesh& rod = model.rod(load.rod);
  const auto name_it = [&](const std::array<Index, 3>& controls) {
    if (!context.name.empty()) model.named.push_back(vector_control(context.name, "N", controls));
  };
  if (load.follower) {
    ForcePlace place;
    place.arc_length = arc_length_of(load.at, rod);
    place.follower = add_follower_force(load.force, place.arc_length, rod, model);
    rod.force_places.push_back(place);
    name_it(model.elements->circulatory[to_size(place.follower)].amount.components);
    return;
  }
  const DeadForce force(load.force, !context.name.empty(), model);
  if (!context.name.empty()) name_it(force.as_controls(model));
  if (load.at.kind == scenario::Location::Kind::All) {
    for (const Index node : rod.nodes) force.act_on(node, 1.0, model);
    return;
  }
  const double s = arc_length_of(load.at, rod);
  const std::vector<Weighted> nodes = node_weights(rod, s, model);
  for (const auto& [place, weight] : nodes) {
    force.act_on(rod.node(place), weight, model);
  }
  ForcePlace place;
  place.arc_length = s;
  if (nodes.size() > 1) place.force = force.as_controls(model);
  rod.force_places.push_back(place);
}

}  // namespace der
