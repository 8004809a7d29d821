#pragma once

#include "der/core/largest_of.hpp"
#include "der/core/types.hpp"

namespace der {

// The loops over degrees of freedom that every Newton iteration runs, in one pass each, over plain
// arrays that do not overlap.

/// Takes the external `force` from `residual`; returns the largest force that was there.
template <class T>
T subtract_force(Index size, const T* __restrict force, T* __restrict residual) {
  return largest_of<T>(size, [&](Index i) {
    const T before = residual[i];
    residual[i] -= force[i];
    return before;
  });
}

/// Adds the lumped inertial forces at `displacement`, those of the stage
///   factor * lumped (displacement - target),
/// to `residual`, and sets `acceleration` to the factor of `lumped`. Returns the largest of these
/// forces.
template <class T>
T add_lumped_inertia(Index size, const T& factor, const T* __restrict lumped,
                     const T* __restrict displacement, const T* __restrict target,
                     T* __restrict acceleration, T* __restrict residual) {
  return largest_of<T>(size, [&](Index i) {
    const T a = factor * (displacement[i] - target[i]);
    const T force = lumped[i] * a;
    acceleration[i] = a;
    residual[i] += force;
    return force;
  });
}

}  // namespace der
