#pragma once

#include "der/core/types.hpp"

namespace der {

/// Numbers that are linear in the load factor.
struct LinearInFactor {
  Vector at_zero;  ///< at the factor 0
  Vector change;   ///< for a unit of the factor

  /// Their values, as an expression that allocates nothing.
  [[nodiscard]] auto at(double factor) const { return at_zero + factor * change; }
};

/// How loads and prescribed motions follow the load factor of a state: 1 is the scene as written,
/// 0 the scene without what varies.
struct LoadVariation {
  LinearInFactor gravity_force;  ///< [N] as in the model
  LinearInFactor dead_force;     ///< [N] as in the model
  LinearInFactor controls;       ///< values of the tables at time 0, in place of the tables
  /// Whether the forces of a given shape are linear in the factor: not where supports move.
  bool is_linear = true;

  /// Whether anything varies at all.
  [[nodiscard]] bool varies() const {
    return controls.change.norm() + gravity_force.change.norm() + dead_force.change.norm() > 0.0;
  }
};

}  // namespace der
