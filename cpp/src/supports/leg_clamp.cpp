#include "supports/leg_clamp.hpp"

#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "model/corner.hpp"
#include "model/corner_twist.hpp"

namespace der {

Clamp clamp_of_leg(const Clamp& clamp, bool arrives, const RodMesh& rod, const Model& model) {
  if (!arrives || !is_corner(rod, clamp.place, model)) return clamp;
  const Vec3 arriving = leg_tangent(rod, clamp.place, true, model);
  Clamp result = clamp;
  if (model.dimension == 3) {
    const Index edge = rod.edge_before(clamp.place);
    result.held.drawn = reference_section_at_end(rod, edge, true, arriving);
  } else {
    const Vec3 leaving = leg_tangent(rod, clamp.place, false, model);
    result.direction -= angle_between(Vec2(arriving.head<2>()), Vec2(leaving.head<2>()));
  }
  return result;
}

SectionFrame reference_section_at_end(const RodMesh& rod, Index edge, bool last,
                                      const Vec3& tangent) {
  if (rod.initial_frames.empty()) return SectionFrame::of(tangent, tangent.unitOrthogonal());
  const SectionFrame& middle = rod.initial_frames[to_size(edge)];
  const Vec3 director = transport(middle.first, middle.tangent, tangent);
  const double beyond = (last ? 0.5 : -0.5) * rod.edge_length[to_size(edge)];
  return SectionFrame::of(tangent, made_perpendicular(director, tangent))
      .turned(rod.initial_twist * beyond);
}

}  // namespace der
