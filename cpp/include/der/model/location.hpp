#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/scenario/location.hpp"

namespace der {

/// A place along a rod as a weighted sum of its nodes (or of its edges).
struct Weighted {
  Index place = 0;  ///< position in RodLayout::nodes, or number of the edge after that position
  double weight = 0.0;
};

/// Rest arc length [m] that a location names (not for Kind::All).
double arc_length_of(const scenario::Location& location, const RodLayout& rod);

/// Rest arc lengths [m] that a location names: those of every node for Kind::All, else one.
std::vector<double> arc_lengths_of(const scenario::Location& location, const RodLayout& rod);

/// Position in RodLayout::nodes of the node at `location`. The reader has checked that there is
/// one.
Index node_at(const scenario::Location& location, const RodLayout& rod);
/// Positions in RodLayout::nodes of the nodes at `location`: every node for Kind::All, else one.
std::vector<Index> nodes_at(const scenario::Location& location, const RodLayout& rod);

/// Weights of the cubic Lagrange polynomial through the (up to) four nodes nearest to arc length
/// `s`; a single node when `s` is at one. Applied to positions it gives the point at `s`; the same
/// weights spread a point force, so force and displacement are work-conjugate. A linear split would
/// move the second moment of the load by f (1 - f) l^2 (f the place in the edge), an error of order
/// l^2 that jumps from mesh to mesh; the cubic keeps the first three moments.
std::vector<Weighted> node_weights(const RodLayout& rod, double s);

/// Weights of the edges whose direction angles, linearly interpolated between edge midpoints, give
/// the direction at arc length `s`. For a moment within half an edge of an end the weights go on to
/// 13/12 and -1/12, which brings the end from the chain's place beside the curve onto it.
std::vector<Weighted> edge_weights(const RodLayout& rod, double s);

}  // namespace der
