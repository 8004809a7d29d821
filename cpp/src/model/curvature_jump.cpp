#include "model/curvature_jump.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "der/core/index.hpp"
#include "model/corner.hpp"
#include "model/reference_rotation.hpp"

namespace der {
namespace {

/// How many cells on either side of a node tell whether the curvature jumps there.
constexpr Index kBeside = 2;

/// Where the rod has the curvature that stands for a node: at the node, or, if it is the turn from
/// one edge to the next, a third of their difference beside it.
enum class Known { AtNodes, BetweenEdges };

/// The curvature of the cells about the nodes of a rod, as a vector [1/m].
class CellCurvature {
 public:
  CellCurvature(const RodMesh& rod, std::vector<Vec3> at_nodes, Known known)
      : rod_(rod), at_nodes_(std::move(at_nodes)), known_(known) {}

  /// After an inner node with two more on either side less before it, if it jumps there: else zero.
  [[nodiscard]] Vec3 jump_at(Index place) const {
    constexpr double kRounding = 1e-6;  // [rad]
    constexpr double kClear = 2.0;
    const auto [before, change_before] = beside(place, -1);
    const auto [after, change_after] = beside(place, 1);
    const Vec3 jump = after - before;
    const double length = rod_.voronoi_length(place);
    if (jump.norm() * length <= kRounding) return Vec3::Zero();
    const double length_before = rod_.edge_length[to_size(rod_.edge_before(place))];
    const double length_after = rod_.edge_length[to_size(rod_.edge_after(place))];
    const double share = 0.5 * length_before / length;
    const Vec3 between = share * before + (1.0 - share) * after;
    const double uncertain = change_before + change_after + (at(place) - between).norm() +
                             beyond_chords(before, length_before) +
                             beyond_chords(after, length_after);
    return jump.norm() > kClear * uncertain ? jump : Vec3(Vec3::Zero());
  }

 private:
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

  /// By how much a circle's turn over a chord is more than its curvature [1/m].
  static double beyond_chords(const Vec3& curvature, double length) {
    const double turn = curvature.norm() * length;
    return turn * turn / 24.0 * curvature.norm();
  }

  /// Where the rod has the curvature of the cell about a node [m].
  [[nodiscard]] double place_of(Index place) const {
    if (known_ == Known::AtNodes) return rod_.arc_length_at(place);
    const double before = rod_.edge_length[to_size(rod_.edge_before(place))];
    const double after = rod_.edge_length[to_size(rod_.edge_after(place))];
    return rod_.arc_length_at(place) + (after - before) / 3.0;
  }

  const RodMesh& rod_;
  std::vector<Vec3> at_nodes_;
  Known known_;
};

/// The vectors about which the drawn rod turns in its cells [1/m].
std::vector<Vec3> reference_curvature(const RodMesh& rod, const Model& model) {
  std::vector<Vec3> at_nodes;
  for (Index place = 0; place < static_cast<Index>(rod.nodes.size()); ++place) {
    const ReferenceRotation turn = reference_rotation(rod, place, model);
    at_nodes.emplace_back(turn.angle / rod.voronoi_length(place) * turn.axis);
  }
  return at_nodes;
}

/// The values of the scene [1/m]: about the third axis of a plane, in space towards the directors.
std::vector<Vec3> given_curvature(const RodMesh& rod) {
  std::vector<Vec3> at_nodes;
  for (const double value : rod.natural_curvature) at_nodes.emplace_back(0.0, 0.0, value);
  for (const Vec2& pair : rod.natural_curvatures) at_nodes.emplace_back(pair[0], pair[1], 0.0);
  return at_nodes;
}

/// The twist that the scene gives, along the third axis [rad/m].
std::vector<Vec3> given_twist(const RodMesh& rod) {
  std::vector<Vec3> at_nodes;
  for (const double value : rod.natural_twist) at_nodes.emplace_back(0.0, 0.0, value);
  return at_nodes;
}

std::vector<CurvatureJump> jumps_of(const CellCurvature& curvature, const RodMesh& rod,
                                    const Model& model) {
  std::vector<CurvatureJump> jumps;
  const auto count = static_cast<Index>(rod.nodes.size());
  if (count <= 2 * kBeside) return jumps;
  const Index first = rod.closed ? 0 : kBeside + 1;
  const Index last = rod.closed ? count - 1 : count - 2 - kBeside;
  for (Index place = first; place <= last; ++place) {
    const Vec3 jump = curvature.jump_at(place);
    if (jump.isZero(0.0)) continue;
    const auto is_corner_beside = [&](Index step) { return is_corner(rod, place + step, model); };
    const std::array<Index, 5> cells{-2, -1, 0, 1, 2};
    if (std::none_of(cells.begin(), cells.end(), is_corner_beside)) jumps.push_back({place, jump});
  }
  return jumps;
}

/// The section of the drawn rod before a node.
const SectionFrame& reference_section(const RodMesh& rod, Index place) {
  return rod.initial_frames[to_size(rod.edge_before(place))];
}

/// Those of the curvatures that the scene gives.
std::vector<CurvatureJump> given_jumps_of(const RodMesh& rod, const Model& model) {
  std::vector<CurvatureJump> jumps =
      jumps_of({rod, given_curvature(rod), Known::AtNodes}, rod, model);
  if (model.dimension == 2) return jumps;
  for (auto& [place, turn] : jumps) {
    const SectionFrame& section = reference_section(rod, place);
    turn = section.tangent.cross(turn[0] * section.first + turn[1] * section.second);
  }
  return jumps;
}

/// Adds those of the twist that the scene gives.
void add_twist_jumps(const RodMesh& rod, const Model& model, std::vector<CurvatureJump>& jumps) {
  for (const auto& [place, twist] : jumps_of({rod, given_twist(rod), Known::AtNodes}, rod, model)) {
    const Index here = place;
    const auto next = std::find_if(jumps.begin(), jumps.end(),
                                   [&](const auto& jump) { return jump.place >= here; });
    const bool is_there = next != jumps.end() && next->place == here;
    const auto own = is_there ? next : jumps.insert(next, {here, Vec3::Zero()});
    own->turn += twist.z() * reference_section(rod, here).tangent;
  }
}

}  // namespace

std::vector<CurvatureJump> reference_jumps_of(const RodMesh& rod, const Model& model) {
  return jumps_of({rod, reference_curvature(rod, model), Known::BetweenEdges}, rod, model);
}

std::vector<CurvatureJump> natural_jumps_of(const RodMesh& rod, const Model& model) {
  const bool bends = model.dimension == 2 ? rod.EI > 0.0 : rod.EI_1 > 0.0 && rod.EI_2 > 0.0;
  const bool has_curvature = model.dimension == 2 || model.has_sections();
  if (!bends || !has_curvature) return {};
  std::vector<CurvatureJump> jumps =
      bends_as_drawn(rod, model) ? rod.reference_jumps : given_jumps_of(rod, model);
  if (!rod.natural_twist.empty()) add_twist_jumps(rod, model, jumps);
  return jumps;
}

double twist_beyond_mean(const RodMesh& rod, Index place, bool after) {
  if (rod.natural_twist.empty()) return 0.0;
  const Vec3 turn = curvature_beyond_mean(rod, place, after, rod.natural_jumps);
  if (turn.isZero(0.0)) return 0.0;  // as at an end, before which there is no section
  return turn.dot(reference_section(rod, place).tangent);
}

Vec3 curvature_beyond_mean(const RodMesh& rod, Index place, bool after,
                           const std::vector<CurvatureJump>& jumps) {
  const auto here = std::find_if(jumps.begin(), jumps.end(), [&](const CurvatureJump& jump) {
    return jump.place == rod.position(place);
  });
  if (here == jumps.end()) return Vec3::Zero();
  const Index other = after ? rod.edge_before(place) : rod.edge_after(place);
  const double share = 0.5 * rod.edge_length[to_size(other)] / rod.voronoi_length(place);
  return (after ? share : -share) * here->turn;
}

double planar_curvature_beside(const RodMesh& rod, Index place, bool after) {
  return rod.natural_curvature[to_size(rod.position(place))] +
         curvature_beyond_mean(rod, place, after, rod.natural_jumps).z();
}

Vec3 turn_from_line(double s, Index first_edge, const RodMesh& rod,
                    const std::vector<CurvatureJump>& jumps) {
  const Index place = first_edge + 1;
  const double node = rod.arc_length_at(place);
  const double before = node - rod.edge_middle(first_edge);
  const double after = rod.edge_middle(place) - node;
  const double share = 1.0 - (s < node ? (node - s) / before : (s - node) / after);
  if (share <= 0.0) return Vec3::Zero();
  return -share * after * curvature_beyond_mean(rod, place, true, jumps);
}

Vec3 natural_turn_from_line(double s, Index first_edge, const RodMesh& rod) {
  return turn_from_line(s, first_edge, rod, rod.natural_jumps) -
         turn_from_line(s, first_edge, rod, rod.reference_jumps);
}

}  // namespace der
