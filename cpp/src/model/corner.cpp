#include "model/corner.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"

namespace der {
namespace {

/// From node to node in the initial shape [m].
Vec3 drawn_edge(const RodLayout& rod, Index edge, const Model& model) {
  const auto point = [&](Index place) {
    return model.initial_positions.segment(model.dof(rod.node(place), 0), model.dimension);
  };
  Vec3 along = Vec3::Zero();
  along.head(model.dimension) = point(edge + 1) - point(edge);
  return along;
}

/// A turn of the drawn rod at a place.
struct Turn {
  double angle = 0.0;        // [rad]
  Vec3 axis = Vec3::Zero();  // unit vector
};

/// No turn where no two edges meet.
Turn turn_at(const RodLayout& rod, Index place, const Model& model) {
  if (!rod.closed && (place <= 0 || place >= rod.num_edges())) return {};
  const Vec3 before = drawn_edge(rod, rod.edge_before(place), model);
  const Vec3 after = drawn_edge(rod, rod.edge_after(place), model);
  const Vec3 across = before.cross(after);
  return {std::atan2(across.norm(), before.dot(after)), across.normalized()};
}

bool is_free_of_stress(const RodLayout& rod) {
  return rod.natural_curvature.empty() && rod.natural_curvatures.empty();
}

bool bends(const RodLayout& rod, const Model& model) {
  return model.dimension == 2 ? rod.EI > 0.0 : rod.EI_1 > 0.0 && rod.EI_2 > 0.0;
}

}  // namespace

bool is_corner(const RodLayout& rod, Index place, const Model& model) {
  constexpr double kLeast = 0.1;        // [rad]
  constexpr double kSharp = kPi / 3.0;  // [rad]
  constexpr double kAlone = 3.0;
  if (!is_free_of_stress(rod) || !bends(rod, model)) return false;
  const Turn here = turn_at(rod, place, model);
  if (here.angle <= kLeast) return false;
  if (here.angle > kSharp) return true;
  const auto the_same_way = [&](Index beside) {
    const Turn turn = turn_at(rod, beside, model);
    return turn.angle * turn.axis.dot(here.axis);
  };
  return here.angle > kAlone * std::max(the_same_way(place - 1), the_same_way(place + 1));
}

std::vector<Index> corners_of(const RodLayout& rod, const Model& model) {
  std::vector<Index> corners;
  for (Index place = 0; place < static_cast<Index>(rod.nodes.size()); ++place) {
    if (is_corner(rod, place, model)) corners.push_back(place);
  }
  return corners;
}

}  // namespace der
