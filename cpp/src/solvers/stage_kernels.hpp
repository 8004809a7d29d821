#pragma once

#include <cstdint>

#include "der/core/types.hpp"

namespace der {

/// The loops over all degrees of freedom that every Newton iteration runs, in one pass each.

/// As many ones as a magnitude has bits, or zero, for each number: which of them count.
using CountMask = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;
constexpr std::int64_t kCounts = INT64_MAX;

/// Largest |x_i|; not a number if one of the x_i is none.
double largest_magnitude(const Vector& x);
/// The same over those that count.
double largest_magnitude(const Vector& x, const CountMask& counts);

/// Takes the external `force` from `residual`; returns the largest magnitude that was there.
double subtract_force(const Vector& force, Vector& residual);

/// Adds the lumped inertial forces at `displacement`, those of the stage
///   factor * lumped (displacement - target),
/// to `residual`, and sets `acceleration` to the factor of `lumped`. Returns the largest magnitude
/// of these forces.
double add_lumped_inertia(double factor, const Vector& lumped, const Vector& displacement,
                          const Vector& target, Vector& acceleration, Vector& residual);

}  // namespace der
