#include "model/curvature_jump.hpp"

#include <algorithm>
#include <array>

#include "der/core/index.hpp"
#include "model/corner.hpp"
#include "model/drawn_turn.hpp"

namespace der {
namespace {

/// The curvature of the drawn rod at its nodes, as the vector about which it turns [1/m].
class DrawnCurvature {
 public:
  DrawnCurvature(const RodLayout& rod, const Model& model) : rod_(rod) {
    for (Index place = 0; place < static_cast<Index>(rod.nodes.size()); ++place) {
      const DrawnTurn turn = drawn_turn(rod, place, model);
      at_nodes_.emplace_back(turn.angle / rod.voronoi_length(place) * turn.axis);
    }
  }

  /// The mean of the cell about a node.
  [[nodiscard]] const Vec3& at(Index place) const {
    return at_nodes_[to_size(rod_.position(place))];
  }

  /// On one side of a place, extrapolated, and by how much that changes it.
  struct OneSided {
    Vec3 value;
    double change = 0.0;
  };
  [[nodiscard]] OneSided beside(Index place, Index step) const {
    const double near = place_of(place + step);
    const double reach = (rod_.arc_length_at(place) - near) / (near - place_of(place + 2 * step));
    const Vec3 change = reach * (at(place + step) - at(place + 2 * step));
    return {at(place + step) + change, change.norm()};
  }

 private:
  /// Where the rod has the curvature of the cell about a node [m].
  [[nodiscard]] double place_of(Index place) const {
    const double before = rod_.edge_length[to_size(rod_.edge_before(place))];
    const double after = rod_.edge_length[to_size(rod_.edge_after(place))];
    return rod_.arc_length_at(place) + (after - before) / 3.0;
  }

  const RodLayout& rod_;
  std::vector<Vec3> at_nodes_;
};

/// The jump at a place with two nodes on either side, if it is one: else zero.
Vec3 jump_at(const RodLayout& rod, Index place, const DrawnCurvature& curvature) {
  constexpr double kRounding = 1e-6;  // [rad]
  constexpr double kClear = 2.0;
  const auto [before, change_before] = curvature.beside(place, -1);
  const auto [after, change_after] = curvature.beside(place, 1);
  const Vec3 jump = after - before;
  const double length = rod.voronoi_length(place);
  if (jump.norm() * length <= kRounding) return Vec3::Zero();
  const double share = 0.5 * rod.edge_length[to_size(rod.edge_before(place))] / length;
  const Vec3 between = share * before + (1.0 - share) * after;
  const double uncertain = change_before + change_after + (curvature.at(place) - between).norm();
  return jump.norm() > kClear * uncertain ? jump : Vec3(Vec3::Zero());
}

}  // namespace

std::vector<CurvatureJump> curvature_jumps_of(const RodLayout& rod, const Model& model) {
  constexpr Index kBeside = 2;
  std::vector<CurvatureJump> jumps;
  if (!bends_as_drawn(rod, model) || (model.dimension == 3 && !model.has_sections())) return jumps;
  const auto count = static_cast<Index>(rod.nodes.size());
  const Index first = rod.closed ? 0 : kBeside + 1;
  const Index last = rod.closed ? count - 1 : count - 2 - kBeside;
  if (count <= 2 * kBeside) return jumps;
  const DrawnCurvature curvature(rod, model);
  for (Index place = first; place <= last; ++place) {
    const Vec3 jump = jump_at(rod, place, curvature);
    if (jump.isZero(0.0)) continue;
    const auto is_corner_beside = [&](Index step) { return is_corner(rod, place + step, model); };
    const std::array<Index, 5> cells{-2, -1, 0, 1, 2};
    if (std::none_of(cells.begin(), cells.end(), is_corner_beside)) jumps.push_back({place, jump});
  }
  return jumps;
}

Vec3 curvature_beyond_mean(const RodLayout& rod, Index place, const Model& model) {
  const std::vector<CurvatureJump> jumps = curvature_jumps_of(rod, model);
  const auto here = std::find_if(jumps.begin(), jumps.end(), [&](const CurvatureJump& jump) {
    return jump.place == rod.position(place);
  });
  if (here == jumps.end()) return Vec3::Zero();
  return 0.5 * rod.edge_length[to_size(rod.edge_before(place))] / rod.voronoi_length(place) *
         here->turn;
}

}  // namespace der
