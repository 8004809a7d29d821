#pragma once

#include <vector>

#include "der/model/model.hpp"

namespace der {

/// Whether a place of a rod that is stress-free as drawn, and bends, is a corner. The scene tells
/// where corners are, but for a rod that is drawn by points. There it is one if its drawn turn is
/// more than 60 degrees, or more than a tenth of a radian and three times what the rod turns the
/// same way at the nodes before and after. In a smooth curve neighbouring turns are alike.
///
/// Corners part a rod into legs. Tangent and section jump there, and what refers to them.
bool is_corner(const RodMesh& rod, Index place, const Model& model);

/// Positions of all corners in RodMesh::nodes, ascending.
std::vector<Index> corners_of(const RodMesh& rod, const Model& model);

}  // namespace der
