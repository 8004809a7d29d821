#include "der/loads/loads.hpp"
#include "der/model/location.hpp"

namespace der {

void add_load(const scenario::PointForce& load, const scenario::Scene& /*scene*/, Model& model) {
  const RodLayout& rod = model.rod(load.rod);
  const DeadForce force(load.force, model);
  if (load.at.kind == scenario::Location::Kind::All) {
    for (const Index node : rod.nodes) force.act_on(node, 1.0, model);
    return;
  }
  for (const auto& [place, weight] : node_weights(rod, arc_length_of(load.at, rod))) {
    force.act_on(rod.nodes[static_cast<std::size_t>(place)], weight, model);
  }
}

}  // namespace der
