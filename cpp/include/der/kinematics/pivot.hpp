#pragma once

#include <cmath>

#include "der/core/types.hpp"

namespace der {

/// The point about which the edge next to a clamp turns: on the clamped tangent, `distance` from
/// the clamped node (supports/clamp.hpp says why it is not the node itself).
struct Pivot {
  static constexpr int kDimension = 2;

  double distance = 0.0;   ///< [m] along the tangent, negative behind the node; 0: the node itself
  double direction = 0.0;  ///< initial angle of the clamped tangent [rad]
  Index rotation = -1;     ///< control that turns the tangent [rad]; -1: none
  Vec2 reference_offset = Vec2::Zero();  ///< from the node [m] before any turn

  Pivot() = default;
  Pivot(double along, double angle, Index control)
      : distance(along), direction(angle), rotation(control), reference_offset(offset(0.0)) {}

  /// From the node to the pivot [m], the tangent being turned by `turn` [rad].
  [[nodiscard]] Vec2 offset(double turn) const {
    if (distance == 0.0) return Vec2::Zero();
    return {distance * std::cos(direction + turn), distance * std::sin(direction + turn)};
  }
  [[nodiscard]] double turn(const Vector& controls) const {
    return rotation >= 0 ? controls[rotation] : 0.0;
  }
  [[nodiscard]] Vec2 offset(const Vector& controls) const {
    return rotation >= 0 ? offset(turn(controls)) : reference_offset;
  }
};

}  // namespace der
