#pragma once

#include "der/core/types.hpp"
#include "der/model/dof_map.hpp"

namespace der {

// The loops over all degrees of freedom that every Newton iteration runs, in one pass each.

/// Takes the external `force` from `residual`; returns the largest force [N] that was there.
double subtract_force(const DofMap& dofs, const Vector& force, Vector& residual);

/// Adds the lumped inertial forces at `displacement`, those of the stage
///   factor * lumped (displacement - target),
/// to `residual`, and sets `acceleration` to the factor of `lumped`. Returns the largest of these
/// forces [N].
double add_lumped_inertia(const DofMap& dofs, double factor, const Vector& lumped,
                          const Vector& displacement, const Vector& target, Vector& acceleration,
                          Vector& residual);

}  // namespace der
