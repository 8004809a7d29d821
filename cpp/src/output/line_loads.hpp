#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

// The loads along a rod, each on a part of it. In a plane the z component is 0.

/// Force [N/m] of a distributed force.
Vec3 force_per_length(const DistributedPlace& place, const Model& model, const State& state);

/// Displacement [m] of a node of a rod from where it is drawn.
Vec3 node_displacement(const RodMesh& rod, Index node, const Model& model, const State& state);

/// Force [N/m] of a foundation at arc length `s` [m], which is on its part: the displacement is
/// linear along each edge.
Vec3 force_per_length(const FoundationPlace& place, double s, const RodMesh& rod,
                      const Model& model, const State& state);

}  // namespace der
