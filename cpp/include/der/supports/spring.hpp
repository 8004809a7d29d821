#pragma once

#include <array>
#include <vector>

#include "der/energies/spatial_joint_spring.hpp"
#include "der/model/model.hpp"

namespace der {

namespace scenario {
struct Spring;
struct Support;
}  // namespace scenario

// A spring against turning acts on the tangent at a place, of which the chain knows only the mean
// directions of the edges beside it: sum w_i theta_i with the weights of a moment there
// (model/location.hpp). Between that sum and the tangent the rod bends under the spring's own
// moment M, by (c/EI) M with a length c of the order of an edge. The elements therefore put spring
// and cell in series, 1/k + c/EI, and a moment that acts at the same place, which bends the cell
// too, turns the sum by as much less. That keeps the order 2, whatever the stiffness, and a stiff
// spring becomes a clamp. docs/mechanics.md derives c.

/// Lengths [m], which times the natural curvature at the rod's first and last node are the part of
/// the weighted directions of two edges that a drawn chain lacks where no moment acts. Beyond the
/// outermost middle the rod bends on to the place `s` [m]; and the node next to a free end lies
/// l^2/12 kappa beside the curve (supports/clamp.hpp), which turns the outermost edge.
/// `weights`: of the edges from `first_edge` on.
std::array<double, 2> natural_turn_lengths(const RodMesh& rod, double s, Index first_edge,
                                           const std::vector<double>& weights);

/// How far [rad] the weighted directions of the edges of a place turn from the drawn shape to one
/// in which no moment acts and the tangent there has its drawn direction; in a plane.
double natural_turn_of_edges(const RodMesh& rod, const MomentPlace& place, const Model& model);

/// Adds the springs of a support: the one to the anchor as an element, the one against turning to
/// the moment places of its rod, where it joins what is at the same place.
void add_spring(const scenario::Support& support, Model& model);

/// A spring against turning at arc length `s` [m] of a rod in space that has legs.
SpatialJointSpring::Constants joint_spring(const scenario::Spring& spring, double s,
                                           const RodMesh& rod, const Model& model);

/// Adds the elements of a rod's springs against turning, before there are moments of loads.
void add_rotational_springs(RodMesh& rod, Model& model);

}  // namespace der
