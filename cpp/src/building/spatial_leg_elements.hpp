#pragma once

#include "der/model/model.hpp"

namespace der {

/// Makes the stretch, bend and twist elements of a rod in space that has legs, from its layout.
void add_spatial_leg_elements(RodMesh& rod, Model& model);

}  // namespace der
