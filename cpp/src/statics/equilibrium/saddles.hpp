#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/statics/stiffness.hpp"
#include "statics/equilibrium/pseudo_transient.hpp"
#include "statics/equilibrium/shape.hpp"
#include "statics/equilibrium/static_loads.hpp"
#include "statics/equilibrium/static_newton.hpp"

namespace der::statics {

/// The displacement along a direction that changes one edge by 1 [rad, or strain] and no edge by
/// more; all degrees of freedom.
Vector unit_displacement(const Model& model, const SoftDirection& soft);

/// Follows the gradient flow from a saddle to both sides along its softest direction. Moves `shape`
/// to the equilibrium of lower potential, to the first one where both are equal. Returns false and
/// leaves the shape as it is if neither side leads to an equilibrium.
bool leave_saddle(const Model& model, const StaticLoads& loads, const StaticNewton& newton,
                  PseudoTransient& continuation, Stiffness& stiffness, Shape& shape);

}  // namespace der::statics
