#pragma once

#include "der/model/model.hpp"

namespace der {

/// Makes the stretch and bend elements of a rod that is one of the model's, from its layout, clamps
/// and springs against turning, and sets its rest turning angles.
void add_rod_elements(RodMesh& rod, Model& model);

}  // namespace der
