#include "model/drawn_turn.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace der {
namespace {

/// From node to node in the initial shape [m].
Vec3 drawn_edge(const RodLayout& rod, Index edge, const Model& model) {
  const auto point = [&](Index place) {
    return model.rest_positions.segment(model.dof(rod.node(place), 0), model.dimension);
  };
  Vec3 along = Vec3::Zero();
  along.head(model.dimension) = point(edge + 1) - point(edge);
  return along;
}

}  // namespace

std::pair<Vec3, Vec3> drawn_edges(const RodLayout& rod, Index place, const Model& model) {
  return {drawn_edge(rod, rod.edge_before(place), model).normalized(),
          drawn_edge(rod, rod.edge_after(place), model).normalized()};
}

DrawnTurn drawn_turn(const RodLayout& rod, Index place, const Model& model) {
  if (!rod.closed && (place <= 0 || place >= rod.num_edges())) return {};
  const Vec3 before = drawn_edge(rod, rod.edge_before(place), model);
  const Vec3 after = drawn_edge(rod, rod.edge_after(place), model);
  const Vec3 across = before.cross(after);
  return {std::atan2(across.norm(), before.dot(after)), across.normalized()};
}

bool bends_as_drawn(const RodLayout& rod, const Model& model) {
  if (!rod.natural_curvature.empty() || !rod.natural_curvatures.empty()) return false;
  return model.dimension == 2 ? rod.EI > 0.0 : rod.EI_1 > 0.0 && rod.EI_2 > 0.0;
}

}  // namespace der
