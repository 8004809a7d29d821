#include "model/reference_rotation.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace der {
namespace {

/// From node to node in the initial shape [m].
Vec3 reference_edge(const RodMesh& rod, Index edge, const Model& model) {
  const auto point = [&](Index place) {
    return model.reference_positions.segment(model.dof(rod.node(place), 0), model.dimension);
  };
  Vec3 along = Vec3::Zero();
  along.head(model.dimension) = point(edge + 1) - point(edge);
  return along;
}

}  // namespace

std::pair<Vec3, Vec3> reference_edges(const RodMesh& rod, Index place, const Model& model) {
  return {reference_edge(rod, rod.edge_before(place), model).normalized(),
          reference_edge(rod, rod.edge_after(place), model).normalized()};
}

ReferenceRotation reference_rotation(const RodMesh& rod, Index place, const Model& model) {
  if (!rod.closed && (place <= 0 || place >= rod.num_edges())) return {};
  const Vec3 before = reference_edge(rod, rod.edge_before(place), model);
  const Vec3 after = reference_edge(rod, rod.edge_after(place), model);
  const Vec3 across = before.cross(after);
  return {std::atan2(across.norm(), before.dot(after)), across.normalized()};
}

bool bends_as_drawn(const RodMesh& rod, const Model& model) {
  if (!rod.natural_curvature.empty() || !rod.natural_curvatures.empty()) return false;
  return model.dimension == 2 ? rod.EI > 0.0 : rod.EI_1 > 0.0 && rod.EI_2 > 0.0;
}

}  // namespace der
