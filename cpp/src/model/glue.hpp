#pragma once

#include "der/model/model.hpp"

namespace der {

/// Whether sections meet at a vertex that are turned against each other by more than rounding.
bool is_glued_turned(const RodVertex& vertex);

/// The same, with no clamp between them.
bool meets_turned(const RodVertex& vertex);

/// Whether the axes of unequal stiffnesses are other ones beyond a vertex: half a turn leaves them
/// as they are.
bool turns_axes(const RodVertex& vertex, const RodMesh& rod);

/// Whether the rod on the two sides of a vertex bends about other axes, or to other natural
/// curvatures that the scene gives.
bool parts_bending(const RodVertex& vertex, const RodMesh& rod);

}  // namespace der
