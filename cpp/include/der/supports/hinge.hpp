#pragma once

#include "der/model/model.hpp"
#include "der/scenario/joint.hpp"

namespace der {

/// Adds the spring and the damping of a joint whose rotations are found; does nothing if it has
/// none.
void add_hinge(const scenario::Joint& joint, Model& model);
/// Lets the legs of the second rod of a driven hinge turn against the joint's rotation; does
/// nothing for others.
void drive_hinge(const scenario::Joint& joint, Model& model);

}  // namespace der
