#include "der/model/location.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/core/nearest_node.hpp"
#include "der/model/clamp_cell.hpp"

namespace der {
namespace {

/// The last edge takes this share of a moment at an end in excess of the whole, and the edge
/// before it takes the negative of this share. That turns the last edge by l kappa/12 more, which
/// moves the end of the chain onto the curve (supports/clamp.hpp).
constexpr double kEndShare = 1.0 / 12.0;

bool is_node(const RodMesh& rod, Index i, double s) {
  return std::abs(rod.arc_length_at(i) - s) <= rod.same_place();
}

}  // namespace

std::vector<Index> turns_of(const RodMesh& rod) {
  if (!rod.closed) return {0};
  return {-1, 0, 1};
}

std::vector<EdgePart> edge_parts(const RodMesh& rod, double from, double to) {
  std::vector<EdgePart> parts;
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    const double a = std::max(from, rod.arc_length_at(edge));
    const double b = std::min(to, rod.arc_length_at(edge + 1));
    if (a < b) parts.push_back({edge, a, b});
  }
  return parts;
}

bool is_cut(const EdgePart& part, const RodMesh& rod) {
  const double s0 = rod.arc_length_at(part.edge);
  const double s1 = rod.arc_length_at(part.edge + 1);
  return part.to - part.from < (s1 - s0) - rod.same_place();
}

double length_at_last_end(const EdgePart& part, const RodMesh& rod) {
  const double s0 = rod.arc_length_at(part.edge);
  const double s1 = rod.arc_length_at(part.edge + 1);
  return (part.to - part.from) * (0.5 * (part.from + part.to) - s0) / (s1 - s0);
}

double tangent_place(const RodMesh& rod, Index edge) {
  const double further = kFirstVertexCorrection * rod.edge_length[to_size(rod.position(edge))];
  return rod.edge_middle(edge) + (rod.clamp_at(edge) != nullptr ? further : 0.0) -
         (rod.clamp_at(edge + 1) != nullptr ? further : 0.0);
}

std::optional<PlaceBesideClamp> place_beside_clamp(const RodMesh& rod, double s) {
  for (std::size_t i = 0; i < rod.clamps.size(); ++i) {
    const Index most = rod.closed ? 1 : 0;
    for (Index turns = -most; turns <= most; ++turns) {
      const Index node = rod.clamps[i].place + turns * rod.num_edges();
      const double from = rod.arc_length_at(node);
      const bool before = s < from || (!rod.closed && node == rod.num_edges());
      const Index edge = before ? node - 1 : node;
      if (edge < 0 && !rod.closed) continue;
      const PlaceBesideClamp place{static_cast<Index>(i), rod.position(edge), std::abs(s - from),
                                   std::abs(tangent_place(rod, edge) - from)};
      if (place.distance < place.reach) return place;
    }
  }
  return std::nullopt;
}

double beyond_outer_middle(const RodMesh& rod, double s) {
  if (rod.closed || place_beside_clamp(rod, s)) return 0.0;
  return std::max({0.0, rod.edge_middle(0) - s, s - rod.edge_middle(rod.num_edges() - 1)});
}

namespace {

double given_arc_length(const scenario::Location& location, const RodMesh& rod) {
  using Kind = scenario::Location::Kind;
  switch (location.kind) {
    case Kind::Start:
      return 0.0;
    case Kind::Middle:
      return 0.5 * rod.rest_length();
    case Kind::End:
      return rod.rest_length();
    case Kind::ArcLength:
      return location.arc_length;
    case Kind::Node: {
      const auto count = static_cast<Index>(rod.nodes.size());
      return rod.arc_length[to_size(location.node < 0 ? location.node + count : location.node)];
    }
    case Kind::All:
      break;
  }
  throw Error("model_error", "rod '" + rod.name + "': 'all' does not name one place");
}

}  // namespace

double arc_length_of(const scenario::Location& location, const RodMesh& rod) {
  const double s = given_arc_length(location, rod);
  const bool at_end = rod.closed && s >= rod.rest_length() - rod.same_place();
  return at_end ? 0.0 : s;
}

std::vector<double> arc_lengths_of(const scenario::Location& location, const RodMesh& rod) {
  if (location.kind == scenario::Location::Kind::All) return rod.arc_length;
  return {arc_length_of(location, rod)};
}

Index node_at(const scenario::Location& location, const RodMesh& rod) {
  const double s = arc_length_of(location, rod);
  const Index node = nearest_node(rod.arc_length, s);
  if (!is_node(rod, node, s)) {
    throw Error("model_error", "rod '" + rod.name + "': no node at arc length " +
                                   std::to_string(s) + " m; the nearest is at " +
                                   std::to_string(rod.arc_length[to_size(node)]) + " m");
  }
  return node;
}

std::vector<Index> nodes_at(const scenario::Location& location, const RodMesh& rod) {
  if (location.kind != scenario::Location::Kind::All) return {node_at(location, rod)};
  std::vector<Index> all(rod.nodes.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
  return all;
}

Index node_of(const scenario::Joint& joint, const Model& model) {
  const scenario::JointMember& member = joint.of.front();
  const RodMesh& rod = model.rod(member.rod);
  return rod.node(node_at(member.at, rod));
}

std::vector<Weighted> edge_weights(const RodMesh& rod, double s) {
  if (const auto beside = place_beside_clamp(rod, s)) return {{beside->edge, beside->share()}};
  const Index edges = rod.num_edges();
  const auto beyond = [&](double distance, Index last, Index before) -> std::vector<Weighted> {
    if (edges == 1) return {{last, 1.0}};
    const double share = kEndShare * distance / (0.5 * rod.edge_length[to_size(last)]);
    return {{last, 1.0 + share}, {before, -share}};
  };
  if (!rod.closed && s <= tangent_place(rod, 0)) return beyond(rod.edge_middle(0) - s, 0, 1);
  if (!rod.closed && s >= tangent_place(rod, edges - 1))
    return beyond(s - rod.edge_middle(edges - 1), edges - 1, edges - 2);
  Index right = rod.closed ? 0 : 1;
  while (tangent_place(rod, right) < s) ++right;
  const double before = tangent_place(rod, right - 1);
  const double share = (s - before) / (tangent_place(rod, right) - before);
  return {{right - 1, 1.0 - share}, {right, share}};
}

}  // namespace der
