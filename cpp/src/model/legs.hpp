#pragma once

#include <vector>

#include "der/model/model.hpp"

namespace der {

/// Positions in RodMesh::nodes at which a leg of a rod ends, ascending: the natural curvature is
/// smooth along a leg. They are the corners (model/corner.hpp) and the jumps of the natural
/// curvature (model/curvature_jump.hpp).
std::vector<Index> leg_bounds(const RodMesh& rod, const Model& model);

}  // namespace der
