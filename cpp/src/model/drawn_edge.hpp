#pragma once

#include "der/model/edge.hpp"
#include "der/model/model.hpp"

namespace der {

/// The vector [m] of an edge of a rod in the drawn shape.
template <int Dim = 2>
Eigen::Matrix<double, Dim, 1> drawn_edge(const RodLayout& rod, Index edge, const Model& model) {
  return along_edge<Dim>(rod.edge(edge, model), model.rest_positions);
}

}  // namespace der
