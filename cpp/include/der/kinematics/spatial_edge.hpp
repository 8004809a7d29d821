#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/held_frame.hpp"

namespace der {

/// EffectiveEdge in space: an edge as its elements see it, from node to node, or from a clamp's
/// pivot.
struct SpatialEdge {
  Index start = 0;   ///< first degree of freedom of the node where it begins
  Index end = 0;     ///< of the node where it ends
  Index theta = -1;  ///< degree of freedom of its angle; -1: it has none
  SpatialPivot first;
  SpatialPivot last;

  [[nodiscard]] bool has_pivot() const { return first.distance != 0.0 || last.distance != 0.0; }
  [[nodiscard]] Vec3 vector(const Vector& coordinates, const Vector& controls) const {
    return coordinates.segment<3>(end) + last.offset(controls) - coordinates.segment<3>(start) -
           first.offset(controls);
  }
  /// The vector [m] in the initial shape, where no clamp has turned yet.
  [[nodiscard]] Vec3 drawn(const Vector& coordinates) const {
    return coordinates.segment<3>(end) + last.reference_offset() - coordinates.segment<3>(start) -
           first.reference_offset();
  }
};

}  // namespace der
