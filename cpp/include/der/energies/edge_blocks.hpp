#pragma once

#include "der/core/types.hpp"

namespace der {

/// Second derivative by the nodes of an edge, from `ee`, that by the edge's vector. Sets the lower
/// triangle of the first rows and columns of `hessian`.
template <class Block, class Hessian>
void set_edge_blocks(const Block& ee, Hessian& hessian) {
  constexpr int n = Block::RowsAtCompileTime;
  hessian.template block<n, n>(0, 0) = ee;
  hessian.template block<n, n>(n, 0) = -ee;
  hessian.template block<n, n>(n, n) = ee;
}

/// The same by the three nodes of two neighbouring edges a and b, from the derivatives by the
/// vectors of both: `aa`, `ba` (rows: b) and `bb`.
template <class Block, class Hessian>
void set_vertex_blocks(const Block& aa, const Block& ba, const Block& bb, Hessian& hessian) {
  constexpr int n = Block::RowsAtCompileTime;
  hessian.template block<n, n>(0, 0) = aa;
  hessian.template block<n, n>(n, 0) = ba - aa;
  hessian.template block<n, n>(2 * n, 0) = -ba;
  hessian.template block<n, n>(n, n) = aa - ba - ba.transpose() + bb;
  hessian.template block<n, n>(2 * n, n) = ba - bb;
  hessian.template block<n, n>(2 * n, 2 * n) = bb;
}

}  // namespace der
