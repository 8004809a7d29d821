#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// A node at which a curvature jumps without a corner: where a straight leg runs into an arc, or
/// one arc into another.
struct CurvatureJump {
  Index place = 0;  ///< position in RodLayout::nodes
  /// The vector about which the rod turns, after the node less before it [1/m], on the drawn rod.
  Vec3 turn = Vec3::Zero();
};

/// All jumps of the curvature of the shape that the rod is drawn with, ascending.
///
/// On either side the curvature is that of the two nodes next to the place, extrapolated. It jumps
/// if the two values differ by more than twice all that is uncertain: what the extrapolations
/// change, what the turn at the node itself differs from that of the two sides, and what chords
/// turn more than the curve. On a smooth curve these are the larger by an order or two of the edge
/// length.
std::vector<CurvatureJump> drawn_jumps_of(const RodLayout& rod, const Model& model);

/// Those of the natural curvature, and so of the curvature in any equilibrium: those of the drawn
/// shape where it is free of stress, and else those of the values that the scene gives at the
/// nodes. The value at the node of a jump is the mean of its cell.
std::vector<CurvatureJump> natural_jumps_of(const RodLayout& rod, const Model& model);

/// By how much the vector about which the rod turns differs along the edge after a place, or along
/// the one before it, from the mean of the cell there [1/m]; zero where no jump is at the place.
Vec3 curvature_beyond_mean(const RodLayout& rod, Index place, bool after,
                           const std::vector<CurvatureJump>& jumps);

/// The rotation [rad] by which the tangent at `s` [m], between the middles of an edge and the next,
/// is turned against the line through theirs: where the curvature jumps at their node, from k_b to
/// k_a, the line cuts off the kink of the tangent's angle, (k_a - k_b) ab/(a + b) at the node, with
/// the distances a and b to the middles.
Vec3 turn_from_line(double s, Index first_edge, const RodLayout& rod,
                    const std::vector<CurvatureJump>& jumps);

/// `turn_from_line` of a rod on which no moment acts, less that of the drawn one: none where the
/// drawn shape is free of stress.
Vec3 natural_turn_from_line(double s, Index first_edge, const RodLayout& rod, const Model& model);

}  // namespace der
