#pragma once

#include "der/model/model.hpp"

namespace der {

/// Whether sections meet at a joint that are turned against each other by more than rounding.
bool is_glued_turned(const RodJoint& joint);

/// The same, with no clamp between them.
bool meets_turned(const RodJoint& joint);

/// Whether the axes of unequal stiffnesses are other ones beyond a joint: half a turn leaves them
/// as they are.
bool turns_axes(const RodJoint& joint, const RodLayout& rod);

/// Whether the rod on the two sides of a joint bends about other axes, or to other natural
/// curvatures that the scene gives.
bool parts_bending(const RodJoint& joint, const RodLayout& rod);

}  // namespace der
