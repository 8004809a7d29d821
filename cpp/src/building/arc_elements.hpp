#pragma once

#include "der/model/model.hpp"

namespace der {

/// Adds what the stretching energy of a leg lacks as its edges are not as long as their arcs
/// (energies/arc_stretch.hpp), which makes the leg one of order 4. Does nothing for a leg that is
/// drawn curved or with cells of unequal length: it stays one of order 2.
void add_arc_elements(Leg& leg, const RodMesh& rod, Model& model);

}  // namespace der
