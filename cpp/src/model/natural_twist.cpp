#include "model/natural_twist.hpp"

#include "der/core/index.hpp"
#include "model/curvature_jump.hpp"

namespace der {

double natural_twist_at(const RodMesh& rod, const RodVertex& vertex) {
  if (rod.natural_twist.empty()) return rod.initial_twist;
  const Index place = vertex.place();
  const bool before = vertex.twist_place < rod.arc_length_at(place);
  if (vertex.clamp < 0 && twist_beyond_mean(rod, place, !before) != 0.0) {
    return rod.natural_twist[to_size(rod.position(place))];
  }
  const Index edge = before ? place - 1 : place;
  const auto at_node = [&](Index node, bool after) {
    return rod.natural_twist[to_size(rod.position(node))] + twist_beyond_mean(rod, node, after);
  };
  const double share =
      (vertex.twist_place - rod.arc_length_at(edge)) / rod.edge_length[to_size(rod.position(edge))];
  return (1.0 - share) * at_node(edge, true) + share * at_node(edge + 1, false);
}

}  // namespace der
