#include "building/force_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "der/core/index.hpp"
#include "der/core/nearest_node.hpp"
#include "der/model/location.hpp"
#include "der/model/node_weights.hpp"
#include "der/scenario/load.hpp"

namespace der {
namespace {

bool bears_force(const scenario::Support& support) {
  return support.holds() || (support.spring && !support.spring->stiffness.empty());
}

/// Calls use(rod, s) with the arc length [m] of each single force of the scene. A load on every
/// node is distributed: its jumps are as small as those of gravity.
template <class Use>
void for_each_force(const scenario::Scene& scene, Model& model, const Use& use) {
  const auto enter = [&](const std::string& name, const scenario::Location& at) {
    RodMesh& rod = model.rod(name);
    for (const double s : arc_lengths_of(at, rod)) use(rod, s);
  };
  for (const scenario::Support& support : scene.supports) {
    if (bears_force(support)) enter(support.rod, support.at);
  }
  for (const auto& load : scene.loads) {
    const auto* force = std::get_if<scenario::PointForce>(&load.what);
    if (force == nullptr || force->at.kind == scenario::Location::Kind::All) continue;
    enter(force->rod, force->at);
  }
}

/// Edges of forces between nodes, in ascending order.
using Edges = std::vector<Index>;

/// Between two edges with forces, whose places may have nodes in common, the node in the middle
/// divides what belongs to them.
void divide_between(const Edges& edges, RodMesh& rod) {
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const Index apart = edges[i + 1] - edges[i];
    if (apart == 0 || apart > 2 * kMostPointNodes) continue;
    rod.divides_places[to_size(rod.position((edges[i] + edges[i + 1] + 1) / 2))] = true;
  }
}

}  // namespace

void find_force_nodes(const scenario::Scene& scene, Model& model) {
  for (RodMesh& rod : model.rods) {
    rod.bears_force.assign(rod.nodes.size(), false);
    for (std::size_t i = 0; i < rod.nodes.size(); ++i) {
      rod.bears_force[i] = rod.sphere_radius[i] > 0.0;
    }
  }
  std::map<const RodMesh*, Edges> between_nodes;
  for_each_force(scene, model, [&](RodMesh& rod, double s) {
    const std::size_t node = to_size(nearest_node(rod.arc_length, s));
    const bool is_node = std::abs(rod.arc_length[node] - s) <= rod.same_place();
    if (is_node) {
      rod.bears_force[node] = true;
    } else {
      const auto behind = std::upper_bound(rod.arc_length.begin(), rod.arc_length.end(), s);
      between_nodes[&rod].push_back(static_cast<Index>(behind - rod.arc_length.begin()) - 1);
    }
  });
  for (RodMesh& rod : model.rods) {
    for (const Leg& leg : rod.legs) {
      rod.bears_force[to_size(leg.first)] = rod.bears_force[to_size(leg.last)] = true;
    }
    rod.divides_places = rod.bears_force;
    Edges& edges = between_nodes[&rod];
    std::sort(edges.begin(), edges.end());
    const bool go_around = rod.closed && !edges.empty() && edges.front() != edges.back();
    if (go_around) edges.push_back(edges.front() + rod.num_edges());
    divide_between(edges, rod);
  }
}

}  // namespace der
