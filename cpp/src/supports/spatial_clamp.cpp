#include "der/supports/spatial_clamp.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/scenario/support.hpp"
#include "der/supports/bearing.hpp"
#include "der/supports/clamp.hpp"
#include "model/corner.hpp"
#include "model/corner_twist.hpp"
#include "model/curvature_jump.hpp"
#include "model/reference_edge.hpp"
#include "supports/leg_clamp.hpp"

namespace der {
namespace {

/// Rotation vector of the turning angle at a place with two edges, per metre [1/m].
Vec3 initial_curvature_vector(const RodMesh& rod, Index inner, const Model& model) {
  const Vec3 before = reference_edge<3>(rod, inner - 1, model);
  const Vec3 after = reference_edge<3>(rod, inner, model);
  const Vec3 axis = before.cross(after);
  const double sine = axis.norm();
  if (sine == 0.0) return Vec3::Zero();
  return std::atan2(sine, before.dot(after)) / (sine * rod.voronoi_length(inner)) * axis;
}

/// Whether the drawn curvature changes at the start of a ring by much more than beside it, where a
/// smooth curve that is resolved changes half as much. A jump that is not told apart shifts the
/// tangent by the square of the edges' length only.
bool jumps_at_start(const RodMesh& ring, const Model& model) {
  constexpr double kLeast = 0.01;  // of the larger curvature
  constexpr double kAlone = 10.0;
  const auto curvature = [&](Index place) { return initial_curvature_vector(ring, place, model); };
  const Vec3 before = curvature(-1);
  const Vec3 after = curvature(1);
  const double change = (after - before).norm();
  return change > kLeast * std::max(before.norm(), after.norm()) &&
         change > kAlone * std::max((before - curvature(-2)).norm(), (curvature(2) - after).norm());
}

/// The tangent at a place on the circle that has the curvature at `inner`, the place itself or one
/// next to it: straight between the place and a corner, and where no two edges meet. Where the
/// curvature jumps at the place, that of the edge after it.
Vec3 tangent_on_circle(const RodMesh& rod, Index place, Index inner, const Model& model) {
  const Index edge = edge_beside(rod, place);
  const Vec3 chord = reference_edge<3>(rod, edge, model).normalized();
  if (!rod.is_inner(inner) || (inner != place && is_corner(rod, inner, model))) return chord;
  Vec3 curvature = initial_curvature_vector(rod, inner, model);
  if (inner == place) {
    curvature += curvature_beyond_mean(rod, place, true, rod.reference_jumps);
  }
  const double half = (edge == place ? -0.5 : 0.5) * rod.edge_length[to_size(edge)];
  const double angle = curvature.norm() * half;
  if (angle == 0.0) return chord;
  return Eigen::AngleAxisd(angle, curvature.normalized()) * chord;
}

SectionFrame reference_section(const RodMesh& rod, Index place, const Model& model) {
  const Index edge = edge_beside(rod, place);
  return reference_section_at_end(rod, edge, edge != place, initial_tangent(rod, place, model));
}

/// The legs at a corner have two tangents, and turning about one of them turns the other.
void check_axis_of_twist(const RodMesh& rod, Index place, const Model& model) {
  if (!is_corner(rod, place, model)) return;
  throw Error("model_error",
              fmt::format("the 'twist' of a clamp turns about its tangent, but the clamp of rod "
                          "'{}' at arc length {:.6g} m is at a corner and holds two. Write "
                          "'rotation: {{axis: [x, y, z], angle: ...}}'",
                          rod.name, rod.arc_length_at(place)));
}

SpatialPivot spatial_pivot_at(const RodMesh& rod, Index place, Index edge, const Model& model) {
  const Clamp* clamp = rod.clamp_at(place);
  if (clamp == nullptr) return {};
  const bool arrives = edge != clamp->place;
  const double side = arrives ? -1.0 : 1.0;
  return {side * clamp_pivot_share() * rod.edge_length[to_size(edge)],
          clamp_of_leg(*clamp, arrives, rod, model).held};
}

}  // namespace

Vec3 initial_tangent(const RodMesh& rod, Index place, const Model& model) {
  if (is_corner(rod, place, model)) return leg_tangent(rod, place, false, model);
  const Index inner = rod.num_edges() < 2 ? place : inner_place_near(rod, place);
  return tangent_on_circle(rod, place, inner, model);
}

Vec3 first_tangent(const RodMesh& rod, const Model& model) {
  const bool is_smooth = rod.closed && !is_corner(rod, 0, model) && !jumps_at_start(rod, model);
  return tangent_on_circle(rod, 0, is_smooth ? 0 : 1, model);
}

void hold_section(const scenario::Support& support, Index place, RodMesh& rod, Model& model) {
  if ((rod.EI_1 == 0.0 && rod.EI_2 == 0.0) || rod.clamp_at(place) != nullptr) return;
  if (is_bearing(support, place, rod, model)) return hold_in_bearing(support, place, rod, model);
  Clamp clamp;
  clamp.place = place;
  clamp.holds_section = support.clamp == scenario::Clamp::Section;
  clamp.held.drawn = reference_section(rod, place, model);
  if (support.axis_rotation) {
    const auto& [axis, angle] = *support.axis_rotation;
    clamp.held.axis = Eigen::Map<const Vec3>(axis.data()).stableNormalized();
    clamp.held.rotation = model.tables.add(angle);
  } else if (support.rotation) {
    clamp.held.rotation = model.tables.add(*support.rotation);
  }
  if (clamp.held.rotation >= 0) clamp.held.inset = model.tables.add({});
  if (support.twist) {
    check_axis_of_twist(rod, place, model);
    clamp.held.twist = model.tables.add(*support.twist);
  }
  rod.clamps.push_back(clamp);
}

SpatialEdge spatial_edge(const RodMesh& rod, Index edge, const Model& model) {
  const Index number = rod.first_edge + edge;
  return {model.dof(rod.node(edge), 0), model.dof(rod.node(edge + 1), 0),
          model.has_sections() ? model.dofs.angle(number) : -1,
          spatial_pivot_at(rod, edge, edge, model), spatial_pivot_at(rod, edge + 1, edge, model)};
}

}  // namespace der
