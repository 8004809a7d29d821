#include "output/ring_numbers.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/output/joint_strain.hpp"

namespace der {
namespace {

/// Signed solid angle of the triangle between three directions (Van Oosterom and Strackee, IEEE
/// Trans. Biomed. Eng. 30, 1983); 0 of vectors without length.
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  const double volume = a.dot(b.cross(c));
  const double rest = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return 2.0 * std::atan2(volume, rest);
}

/// Solid angle of the directions from the points of one edge to those of another, positive where
/// they are seen to cross right-handed.
double crossing_angle(const Vec3& start, const Vec3& end, const Vec3& other_start,
                      const Vec3& other_end) {
  const Vec3 a = other_start - start;
  const Vec3 b = other_end - start;
  const Vec3 c = other_end - end;
  const Vec3 d = other_start - end;
  return solid_angle(a, c, b) + solid_angle(a, d, c);
}

/// Twist [rad] from the edge before a clamp to the edge after it, which is what writhe goes with.
/// The twists of its two cells, by way of the held tangent, tell the whole turns.
double twist_across(const RodJoint& arriving, const RodJoint& leaving, const RodLayout& rod,
                    const Model& model, const State& state) {
  const auto frame = [&](Index edge) { return section_frame(model, rod.first_edge + edge, state); };
  const double cells =
      strain_of(arriving, rod, model, state).twist + strain_of(leaving, rod, model, state).twist;
  const SectionFrame after = frame(leaving.after).turned(-arriving.glued);
  return nearest_turn(twist_between(frame(arriving.before), after), cells);
}

/// Twist [rad] of all joints of a ring.
double whole_twist_of(const RodLayout& rod, const Model& model, const State& state) {
  const std::size_t count = rod.joints.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const RodJoint& joint = rod.joints[i];
    if (joint.clamp < 0) {
      sum += strain_of(joint, rod, model, state).twist;
    } else if (joint.before >= 0) {
      sum += twist_across(joint, rod.joints[(i + 1) % count], rod, model, state);
    }
  }
  return sum;
}

}  // namespace

double writhe_of(const RodLayout& rod, const Model& model, const State& state) {
  const auto point = [&](Index place) -> Vec3 {
    return state.positions.segment<3>(model.dof(rod.node(place), 0));
  };
  const Index edges = rod.num_edges();
  double sum = 0.0;
  for (Index i = 0; i < edges; ++i) {
    const Vec3 start = point(i);
    const Vec3 end = point(i + 1);
    // Neighbours lie in a plane: no direction shows them crossing.
    const Index last = i == 0 ? edges - 1 : edges;
    for (Index j = i + 2; j < last; ++j) sum += crossing_angle(start, end, point(j), point(j + 1));
  }
  return sum / (2.0 * kPi);
}

double link_of(const RodLayout& rod, const Model& model, const State& state) {
  return whole_twist_of(rod, model, state) / (2.0 * kPi) + writhe_of(rod, model, state);
}

}  // namespace der
