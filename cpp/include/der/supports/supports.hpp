#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/scenario/scenario.hpp"

namespace der {

/// Holds or moves the components that a support names, and lists the half-cell elements of a clamp.
/// Must run after the rods are built.
void add_support(const scenario::Support& support, Model& model);

/// Whether a support clamps the node at position `place` of a rod (its bending then belongs to the
/// clamp's half cells).
bool is_clamped(const scenario::Scene& scene, const RodLayout& rod, Index place);

/// Moves the held degrees of freedom of `positions` to where the tables put them.
void place_held(const Model& model, const Vector& controls, Vector& positions);

}  // namespace der
