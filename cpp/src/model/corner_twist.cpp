#include "model/corner_twist.hpp"

#include <Eigen/Geometry>

#include "der/core/index.hpp"
#include "der/kinematics/section_frame.hpp"
#include "model/corner.hpp"
#include "model/reference_rotation.hpp"

namespace der {
Vec3 leg_tangent(const RodMesh& rod, Index corner, bool arrives, const Model& model) {
  const auto [before, after] = reference_edges(rod, corner, model);
  const Vec3& edge = arrives ? before : after;
  const Index beside = arrives ? corner - 1 : corner + 1;
  const ReferenceRotation turn = reference_rotation(rod, beside, model);
  if (turn.angle == 0.0 || is_corner(rod, beside, model)) return edge;
  const Index number = arrives ? rod.edge_before(corner) : rod.edge_after(corner);
  const double half = 0.5 * rod.edge_length[to_size(number)];
  const double angle = half / rod.voronoi_length(beside) * turn.angle;
  return Eigen::AngleAxisd(arrives ? angle : -angle, turn.axis) * edge;
}

double corner_twist(const RodMesh& rod, Index place, const Model& model) {
  constexpr double kFoldedBack = 1e-6;  // opposite tangents have no smallest rotation
  if (!is_corner(rod, place, model)) return 0.0;
  const auto [before, after] = reference_edges(rod, place, model);
  const Vec3 arriving = leg_tangent(rod, place, true, model);
  const Vec3 leaving = leg_tangent(rod, place, false, model);
  if (1.0 + arriving.dot(leaving) < kFoldedBack) return 0.0;
  const Vec3 director = reference_rotation(rod, place, model).axis;
  Vec3 moved = transport(director, before, arriving);
  moved = transport(moved, arriving, leaving);
  moved = transport(moved, leaving, after);
  return twist_between(SectionFrame::of(before, director), SectionFrame::of(after, moved));
}

}  // namespace der
