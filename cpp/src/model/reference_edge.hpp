#pragma once

#include "der/model/edge.hpp"
#include "der/model/model.hpp"

namespace der {

/// The vector [m] of an edge of a rod in the drawn shape.
template <int Dim = 2>
Eigen::Matrix<double, Dim, 1> reference_edge(const RodMesh& rod, Index edge, const Model& model) {
  return along_edge<Dim>(rod.edge(edge, model), model.reference_positions);
}

}  // namespace der
