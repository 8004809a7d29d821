#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/spatial_edge.hpp"
#include "der/model/model.hpp"

namespace der {

namespace scenario {
struct Support;
}

// Clamps in space: those of supports/clamp.hpp with a section frame. The edge beside a clamp starts
// from the same pivot and bends over the same cell; its section is twisted against the held one
// over the half of the edge that lies between them.

/// Unit tangent at a node of the initial shape: that of the circle through the node's
/// neighbourhood, at a corner that of the leg which leaves it.
Vec3 initial_tangent(const RodMesh& rod, Index place, const Model& model);
/// The same at the start of a rod, as the rod has it behind its first node: where a ring starts at
/// a corner, or where its drawn curvature jumps, that of the open rod through its nodes.
Vec3 first_tangent(const RodMesh& rod, const Model& model);

/// Enters a clamp into the layout of `rod`, which is one of the model's. The rod's elements are
/// made after it. Without effect on a rod that does not bend.
void hold_section(const scenario::Support& support, Index place, RodMesh& rod, Model& model);

/// An edge of a rod as its elements see it.
SpatialEdge spatial_edge(const RodMesh& rod, Index edge, const Model& model);

}  // namespace der
