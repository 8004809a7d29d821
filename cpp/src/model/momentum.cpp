#include "der/model/momentum.hpp"

#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

Momenta momenta(const Model& model, const State& state) {
  Momenta result;
  const Vector momentum = model.mass.momentum(state.velocities);
  for (Index node = 0; node < model.num_nodes; ++node) {
    Vec3 place = Vec3::Zero();
    Vec3 linear = Vec3::Zero();
    for (int c = 0; c < model.dimension; ++c) {
      place[c] = state.positions[model.dof(node, c)];
      linear[c] = momentum[model.dof(node, c)];
    }
    result.linear += linear;
    result.angular += place.cross(linear);
  }
  if (model.framed_edges.empty()) return result;
  const Configuration here = configuration_of(model, state);
  for (const SpatialEdge& edge : model.framed_edges) {
    result.angular +=
        momentum[edge.theta] * edge.vector(here.coordinates, here.controls).normalized();
  }
  return result;
}

}  // namespace der
