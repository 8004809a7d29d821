#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/scenario/series.hpp"

namespace der {

// Loads that have no potential (energies/circulatory_load.hpp). The rod's elements have to be there
// before.

/// Adds a force [N] at arc length `s` [m] that turns with the rod: in space with its section, in a
/// plane with its tangent. Its components are those in the initial shape. Returns the number of the
/// load in ElementLists::circulatory.
Index add_follower_force(const scenario::VectorSeries& force, double s, const RodMesh& rod,
                         Model& model);

/// Adds a moment [N m] at arc length `s` [m] of a rod whose sections count. It keeps its direction,
/// or it turns with the section; its components are then those in the initial shape.
void add_spatial_moment(const scenario::VectorSeries& moment, bool follower, double s, RodMesh& rod,
                        Model& model);

/// Makes the loads of a rod act on sections that their edges do not tell, and see each other there
/// (energies/loaded_section.hpp), once all of them have been added.
void act_on_loaded_sections(const RodMesh& rod, Model& model);

/// Lets the forces that follow a rod in its plane turn with the tangent where moments of loads or
/// springs against turning act at the same place, between two edges: where these turn by w it turns
/// by (w + c M/EI)/(1 + k c/EI) (MomentPlace).
void turn_followers_under_moments(const RodMesh& rod, Model& model);

}  // namespace der
