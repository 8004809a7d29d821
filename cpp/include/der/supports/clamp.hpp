#pragma once

#include "der/model/model.hpp"
#include "der/scenario/scenario.hpp"

namespace der {

/// Angle [rad] of the tangent at a node of the initial shape: that of the circle through the node's
/// neighbourhood, so that a clamp on a drawn arc holds the arc's tangent and not the chord's.
double initial_tangent_angle(const RodLayout& rod, Index place, const Model& model);

/// Adds the half cells of a clamp: bending between the held tangent at the node and the edge on
/// either side of it.
void add_clamp(const scenario::Support& support, const RodLayout& rod, Index place, Model& model);

}  // namespace der
