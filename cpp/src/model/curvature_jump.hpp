#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// For RodMesh::reference_jumps of a rod that is drawn by points: all jumps of the curvature of the
/// shape that it is drawn with. Of other rods the scene tells them.
///
/// On either side the curvature is that of the two nodes next to the place, extrapolated. It jumps
/// if the two values differ by more than twice all that is uncertain: what the extrapolations
/// change, what the turn at the node itself differs from that of the two sides, and what chords
/// turn more than the curve. On a smooth curve these are the larger by an order or two of the edge
/// length.
std::vector<CurvatureJump> reference_jumps_of(const RodMesh& rod, const Model& model);

/// For RodMesh::natural_jumps: the drawn ones where the drawn shape is free of stress, and else
/// those of the curvatures that the scene gives at the nodes; those of the twist that it gives. The
/// value at the node of a jump is the mean of its cell.
std::vector<CurvatureJump> natural_jumps_of(const RodMesh& rod, const Model& model);

/// By how much the natural twist along the edge after a place, or along the one before it, differs
/// from the mean of the cell there [rad/m]; zero where no jump is at the place.
double twist_beyond_mean(const RodMesh& rod, Index place, bool after);

/// By how much the curvature, as the vector about which the rod turns, differs along the edge after
/// a place, or along the one before it, from the mean of the cell there [1/m]; zero where no jump
/// is at the place.
Vec3 curvature_beyond_mean(const RodMesh& rod, Index place, bool after,
                           const std::vector<CurvatureJump>& jumps);

/// Natural curvature of a planar rod, where the scene gives it, at a place as the edge after it has
/// it, or the one before it [1/m].
double planar_curvature_beside(const RodMesh& rod, Index place, bool after);

/// The rotation [rad] by which the tangent at `s` [m], between the middles of an edge and the next,
/// is turned against the line through theirs: where the curvature jumps at their node, from k_b to
/// k_a, the line cuts off the kink of the tangent's angle, (k_a - k_b) ab/(a + b) at the node, with
/// the distances a and b to the middles.
Vec3 turn_from_line(double s, Index first_edge, const RodMesh& rod,
                    const std::vector<CurvatureJump>& jumps);

/// `turn_from_line` of a rod on which no moment acts, less that of the drawn one: none where the
/// drawn shape is free of stress.
Vec3 natural_turn_from_line(double s, Index first_edge, const RodMesh& rod);

}  // namespace der
