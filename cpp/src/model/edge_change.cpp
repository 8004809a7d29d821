#include "der/model/edge_change.hpp"

#include <algorithm>
#include <cmath>

namespace der {

double largest_edge_change(const Model& model, const Vector& displacement) {
  double largest = 0.0;  // squared
  for (const Edge& edge : model.edges) {
    largest =
        std::max(largest, along_edge(edge, displacement).squaredNorm() * edge.per_squared_length);
  }
  return std::sqrt(largest);
}

}  // namespace der
