#include "output/ring_numbers.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <vector>

#include "der/core/constants.hpp"
#include "der/output/joint_strain.hpp"
#include "der/supports/spatial_clamp.hpp"

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

/// The corners [m] of the polygon whose sides the joints of a ring turn against each other. It is
/// that of the nodes, but for its way along the held tangent from one pivot of a clamp to the other
/// (supports/clamp.hpp), where it passes through the node.
std::vector<Vec3> polygon_of(const RodLayout& rod, const Model& model, const State& state) {
  std::vector<Vec3> corners;
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    const SpatialEdge own = spatial_edge(rod, edge, model);
    corners.push_back(effective_end(own, false, model, state));
    if (own.last.distance != 0.0) corners.push_back(effective_end(own, true, model, state));
  }
  return corners;
}

/// Twist [rad] of all joints of a ring.
double whole_twist_of(const RodLayout& rod, const Model& model, const State& state) {
  double sum = 0.0;
  for (const RodJoint& joint : rod.joints) sum += strain_of(joint, rod, model, state).twist;
  return sum;
}

}  // namespace

double writhe_of(const RodLayout& rod, const Model& model, const State& state) {
  const std::vector<Vec3> corners = polygon_of(rod, model, state);
  const std::size_t sides = corners.size();
  const auto end_of = [&](std::size_t side) { return corners[(side + 1) % sides]; };
  double sum = 0.0;
  for (std::size_t i = 0; i < sides; ++i) {
    // Neighbours lie in a plane: no direction shows them crossing.
    const std::size_t last = i == 0 ? sides - 1 : sides;
    for (std::size_t j = i + 2; j < last; ++j) {
      sum += crossing_angle(corners[i], end_of(i), corners[j], end_of(j));
    }
  }
  return sum / (2.0 * kPi);
}

double link_of(const RodLayout& rod, const Model& model, const State& state) {
  return whole_twist_of(rod, model, state) / (2.0 * kPi) + writhe_of(rod, model, state);
}

}  // namespace der
