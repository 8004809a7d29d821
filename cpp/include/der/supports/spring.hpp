#pragma once

#include "der/model/model.hpp"

namespace der {

namespace scenario {
struct Support;
}

// A spring against turning acts on the tangent at a place, of which the chain knows only the mean
// directions of the edges beside it: sum w_i theta_i with the weights of a moment there
// (model/location.hpp). Between that sum and the tangent the rod bends under the spring's own
// moment M, by (c/EI) M with a length c of the order of an edge. The elements therefore put spring
// and cell in series, 1/k + c/EI, and a moment that acts at the same place, which bends the cell
// too, turns the sum by as much less. That keeps the order 2, whatever the stiffness, and a stiff
// spring becomes a clamp. docs/mechanics.md derives c.

/// Adds the springs of a support: the one to the anchor as an element, the one against turning to
/// the moment places of its rod, where it joins what is at the same place.
void add_spring(const scenario::Support& support, Model& model);

/// Adds the elements of a rod's springs against turning, before there are moments of loads.
void add_rotational_springs(RodLayout& rod, Model& model);

}  // namespace der
