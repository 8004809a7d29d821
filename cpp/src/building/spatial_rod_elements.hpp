#pragma once

#include "der/model/model.hpp"

namespace der {

/// Makes the stretch, bend and twist elements of a rod in space that is one of the model's, from
/// its layout and clamps, and sets its rest strains. Rods are taken in their order.
void add_spatial_rod_elements(RodMesh& rod, Model& model);

/// The frames of a rod's edges, as their elements see these: from pivot to pivot.
void draw_frames(const RodMesh& rod, Model& model);
/// Holds the angles of a rod whose sections nothing turns.
void hold_angles(const RodMesh& rod, Model& model);

}  // namespace der
