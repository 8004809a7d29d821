#pragma once

#include "der/model/model.hpp"

namespace der {

/// Makes the stretch and bend elements of a rod that has legs, and sets its rest turning angles.
void add_leg_elements(RodMesh& rod, Model& model);

}  // namespace der
