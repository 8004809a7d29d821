#pragma once

#include <utility>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// A turn of the rod as drawn, from one edge to the next.
struct ReferenceRotation {
  double angle = 0.0;        ///< [rad]
  Vec3 axis = Vec3::Zero();  ///< unit vector
};

/// Unit vectors along the two edges that meet at a place, as drawn.
std::pair<Vec3, Vec3> reference_edges(const RodMesh& rod, Index place, const Model& model);

/// The turn at a place; none where no two edges meet.
ReferenceRotation reference_rotation(const RodMesh& rod, Index place, const Model& model);

/// Whether a rod bends and is free of stress as it is drawn.
bool bends_as_drawn(const RodMesh& rod, const Model& model);

}  // namespace der
