#pragma once

#include "der/model/model.hpp"

namespace der {

/// Makes the stretch and bend elements of a rod that has legs, and sets its rest turning angles.
/// With arcs its legs are of order 4 where they can be (building/arc_elements.hpp).
void add_leg_elements(RodMesh& rod, bool with_arcs, Model& model);

}  // namespace der
