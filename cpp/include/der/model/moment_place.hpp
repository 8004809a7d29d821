#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

// The chain knows the directions of its edges, not the rod's tangent. Moments at a place act on a
// weighted sum w of two directions (model/location.hpp), and under the moment m that they leave to
// the rod its tangent t there turns further, since the rod bends between the two:
//   t = w + c m/EI,   m = M - k t = (M - k w) / (1 + k c/EI),
// M the moment of the loads, k the stiffness of springs against turning, all turns counted from
// where the springs are slack. The elements carry what depends on positions, with the same forces;
// here is the rest: what the cell stores, c m^2/(2 EI), and the difference between the energy of
// the springs, 1/2 k t^2, and that of their element. Without it the energies are of order 1.
// docs/mechanics.md derives c.

/// The edges on which moments at arc length `s` [m] of a rod act, as its elements see them.
MomentPlace moment_place(double s, const RodMesh& rod);

/// The place of moments at arc length `s` [m] of a rod, made if it is not there.
MomentPlace& place_of_moments(double s, RodMesh& rod);

/// Moment [N m] that acts on the rod where loads apply `applied`: less what the springs take.
double carried_moment(const MomentPlace& place, const RodMesh& rod, const Model& model,
                      const State& state, double applied);

/// Energies [J] of the cells under the moments of a rod: of bending, and of springs besides that of
/// their elements.
Energies cell_energies(const RodMesh& rod, const Model& model, const Configuration& here);

/// Work [J] that the loads' moments do on the cells in a step: with t = share (w + c M/EI) the
/// edges turn by share w, and the rest of the tangent's turn depends on M alone. In space it also
/// depends on how the section lies that a moment of a fixed direction bends.
double cell_work(const Model& model, const Configuration& start, const Configuration& end);

}  // namespace der
