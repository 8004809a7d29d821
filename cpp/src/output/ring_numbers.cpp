#include "output/ring_numbers.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "der/core/constants.hpp"
#include "der/output/vertex_strain.hpp"
#include "der/supports/spatial_clamp.hpp"

namespace der {
namespace {

/// Signed solid angle of the triangle between three directions whose triple product is `volume`
/// (Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30, 1983); 0 of vectors without length.
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c, double volume) {
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  const double rest = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return 2.0 * std::atan2(volume, rest);
}

/// Solid angle of the directions from the points of one side to those of another, positive where
/// they are seen to cross right-handed. Sides in a plane are seen to cross from nowhere, whether or
/// not they meet; `rounding` is that of the coordinates [m].
double crossing_angle(const Vec3& start, const Vec3& end, const Vec3& other_start,
                      const Vec3& other_end, double rounding) {
  const Vec3 a = other_start - start;
  const Vec3 b = other_end - start;
  const Vec3 c = other_end - end;
  const Vec3 d = other_start - end;
  const Vec3 side = end - start;
  const Vec3 other = other_end - other_start;
  // By up to four faces of the tetrahedron between the sides, each of which has one of them.
  constexpr double kFaces = 8.0;
  const double length = std::max(side.norm(), other.norm());
  const double apart = std::max({a.norm(), b.norm(), c.norm(), d.norm()});
  const double volume = a.dot(other.cross(side));
  if (std::abs(volume) <= kFaces * rounding * length * apart) return 0.0;
  return solid_angle(a, c, b, volume) + solid_angle(a, d, c, volume);
}

/// The corners [m] of the polygon whose sides the vertices of a ring turn against each other. It is
/// that of the nodes, but for its way along the held tangent from one pivot of a clamp to the other
/// (supports/clamp.hpp), where it passes through the node.
std::vector<Vec3> polygon_of(const RodMesh& rod, const Model& model, const State& state) {
  std::vector<Vec3> corners;
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    const SpatialEdge own = spatial_edge(rod, edge, model);
    corners.push_back(effective_end(own, false, model, state));
    if (own.last.distance != 0.0) corners.push_back(effective_end(own, true, model, state));
  }
  return corners;
}

/// Twist [rad] of all vertices of a ring.
double whole_twist_of(const RodMesh& rod, const Model& model, const State& state) {
  double sum = 0.0;
  for (const RodVertex& vertex : rod.vertices) sum += strain_of(vertex, rod, model, state).twist;
  return sum;
}

}  // namespace

double writhe_of(const RodMesh& rod, const Model& model, const State& state) {
  if (model.dimension == 2) return 0.0;
  const std::vector<Vec3> corners = polygon_of(rod, model, state);
  const std::size_t sides = corners.size();
  const auto end_of = [&](std::size_t side) { return corners[(side + 1) % sides]; };
  double largest = 0.0;
  for (const Vec3& corner : corners) largest = std::max(largest, corner.lpNorm<Eigen::Infinity>());
  const double rounding = 2.0 * std::numeric_limits<double>::epsilon() * largest;
  double sum = 0.0;
  for (std::size_t i = 0; i < sides; ++i) {
    // Neighbours lie in a plane.
    const std::size_t last = i == 0 ? sides - 1 : sides;
    for (std::size_t j = i + 2; j < last; ++j) {
      sum += crossing_angle(corners[i], end_of(i), corners[j], end_of(j), rounding);
    }
  }
  return sum / (2.0 * kPi);
}

double link_of(const RodMesh& rod, const Model& model, const State& state) {
  return whole_twist_of(rod, model, state) / (2.0 * kPi) + writhe_of(rod, model, state);
}

}  // namespace der
