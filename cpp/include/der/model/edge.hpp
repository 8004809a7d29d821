#pragma once

#include "der/core/types.hpp"

namespace der {

/// An edge of the graph of nodes, given by the entries of a field at its two nodes. A field, such
/// as positions, displacements or velocities, stores the components of one node after another.
struct Edge {
  Index first = 0;                  ///< first component of the node where it begins
  Index last = 0;                   ///< first component of the node where it ends
  double rest_length = 0.0;         ///< [m]
  double per_squared_length = 0.0;  ///< over the rest length squared [1/m^2]

  Edge() = default;
  Edge(Index from, Index to, double length)
      : first(from), last(to), rest_length(length), per_squared_length(1.0 / (length * length)) {}
};

/// The field's value at the end of an edge less that at its start: of positions the edge vector
/// [m], of displacements its change [m], of velocities the rate of that [m/s].
template <int Dim = 2>
Eigen::Matrix<double, Dim, 1> along_edge(const Edge& edge, const Vector& field) {
  return field.segment<Dim>(edge.last) - field.segment<Dim>(edge.first);
}

}  // namespace der
