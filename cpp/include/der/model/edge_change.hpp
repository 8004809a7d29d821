#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// Largest change of an edge vector by a displacement, over the edge's rest length: an angle [rad]
/// for motion across the edge, and for a change of the angle of its section. Rigid translation does
/// not count.
double largest_edge_change(const Model& model, const Vector& displacement);

}  // namespace der
