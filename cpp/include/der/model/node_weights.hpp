#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// A place along a rod as a weighted sum of its nodes (or of its edges).
struct Weighted {
  Index place = 0;  ///< of the node (RodMesh::node), or number of the edge after that place
  double weight = 0.0;
};

/// The most nodes that a place is a sum of.
inline constexpr int kMostPointNodes = 6;

/// Weights of the nodes about arc length `s` [m] for the point of the rod there; a single node when
/// `s` is at one. The same weights spread a point force, so that force and displacement are
/// work-conjugate.
///
/// Weights of five or six nodes reproduce cubics, so that a load keeps its first three moments. A
/// linear split between two nodes would move the second moment by f (1 - f) l^2 (f the place in the
/// edge), an error of order l^2 that jumps from mesh to mesh. And the point gives way to a force
/// along the rod as the rod does. At the force the strain jumps: the displacements that a unit
/// force at s_i causes at s_j have the kink -|s_i - s_j| / (2 EA), which is 0 where the force
/// stands. The chain has sum_ij w_i w_j of that, and the one degree of freedom that is left in the
/// weights makes it 0. Otherwise the point would be off by a part of an edge's length times the
/// strain, and the force would stand there: an error of order 1 of the whole solution.
///
/// The nodes are those of one leg (model/corner.hpp), and of the stretch between two nodes on which
/// other forces act, where that has at least four nodes: strain jumps there, too. Forces in two
/// edges have no nodes in common but one: so neither sees the jump of the other.
/// With four nodes the weights are those of the cubic through them, with fewer nodes those of the
/// polynomial. Where an edge at an end is much longer than its neighbours the third moment is given
/// up.
std::vector<Weighted> node_weights(const RodMesh& rod, double s, const Model& model);

}  // namespace der
