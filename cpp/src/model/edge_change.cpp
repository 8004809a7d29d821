#include "der/model/edge_change.hpp"

#include <algorithm>
#include <cmath>

#include "der/model/dimension.hpp"

namespace der {

double largest_edge_change(const Model& model, const Vector& displacement) {
  double largest = 0.0;  // squared
  with_dimension(model, [&](auto dim) {
    for (const Edge& edge : model.edges) {
      const double squared = along_edge<dim>(edge, displacement).squaredNorm();
      largest = std::max(largest, squared * edge.per_squared_length);
    }
  });
  for (const SpatialEdge& edge : model.framed_edges) {
    largest = std::max(largest, displacement[edge.theta] * displacement[edge.theta]);
  }
  return std::sqrt(largest);
}

}  // namespace der
