#pragma once

#include "der/model/model.hpp"

namespace der {

namespace scenario {
struct Support;
}

// A bearing: a `clamp: tangent` inside a rod in space, which holds the node and the tangent there,
// and lets the rod spin and pass on its torque. Two cells of a clamp would part the sections on its
// two sides. Springs against turning about the two directors do not (supports/section_spring.hpp):
// the bearing is one that is far stiffer than the rod, and they are exact for any stiffness.

/// Whether a support lets a rod spin at a place where it goes on to both sides.
bool lets_spin_inside(const scenario::Support& support, Index place, const RodMesh& rod);

/// The same in a model whose sections count: it is a bearing.
bool is_bearing(const scenario::Support& support, Index place, const RodMesh& rod,
                const Model& model);

/// Enters a bearing into the layout of a rod, before its elements are made. Throws where the place
/// is a corner, which has two tangents, and where the support would turn it.
void hold_in_bearing(const scenario::Support& support, Index place, RodMesh& rod,
                     const Model& model);

}  // namespace der
