#include "output/line_loads.hpp"

#include <algorithm>

#include "der/core/index.hpp"

namespace der {

Vec3 force_per_length(const DistributedPlace& place, const Model& model, const State& state) {
  Vec3 force = Vec3::Zero();
  for (int c = 0; c < model.dimension; ++c) {
    force[c] = control_value(model, state, place.force[to_size(c)]);
  }
  return force;
}

Vec3 node_displacement(const RodMesh& rod, Index node, const Model& model, const State& state) {
  const Index dof = model.dof(rod.node(node), 0);
  Vec3 displacement = Vec3::Zero();
  for (int c = 0; c < model.dimension; ++c) {
    displacement[c] = state.positions[dof + c] - model.initial_positions[dof + c];
  }
  return displacement;
}

Vec3 force_per_length(const FoundationPlace& place, double s, const RodMesh& rod,
                      const Model& model, const State& state) {
  const auto& arc = rod.arc_length;
  const auto beyond = std::upper_bound(arc.begin() + 1, rod.closed ? arc.end() : arc.end() - 1, s);
  const auto last = static_cast<Index>(beyond - arc.begin());
  const double share = (s - arc[to_size(last - 1)]) / rod.edge_length[to_size(last - 1)];
  const Vec3 displacement = (1.0 - share) * node_displacement(rod, last - 1, model, state) +
                            share * node_displacement(rod, last, model, state);
  return -place.stiffness.cwiseProduct(displacement);
}

}  // namespace der
