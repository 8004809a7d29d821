#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// A node at which the curvature of a rod that is stress-free as drawn jumps without a corner:
/// where a straight leg runs into an arc, or one arc into another.
struct CurvatureJump {
  Index place = 0;  ///< position in RodLayout::nodes
  /// The vector about which the drawn rod turns, after the node less before it [1/m].
  Vec3 turn = Vec3::Zero();
};

/// All of them, ascending.
///
/// On either side the curvature is that of the two nodes next to the place, extrapolated. It jumps
/// if the two values differ by more than twice all that is uncertain: what the extrapolations
/// change, and what the turn at the node itself differs from that of the two sides. Where the rod
/// is drawn smoothly, these are the larger by an order or two of the edge length.
std::vector<CurvatureJump> curvature_jumps_of(const RodLayout& rod, const Model& model);

/// By how much the vector about which the drawn rod turns differs along the edge after an inner
/// place from the mean of the cell there [1/m]; zero where the curvature does not jump.
Vec3 curvature_beyond_mean(const RodLayout& rod, Index place, const Model& model);

}  // namespace der
