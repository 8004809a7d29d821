#pragma once

#include <array>

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/pivot.hpp"

namespace der {

/// An edge as its elements see it: from node to node, or from a clamp's pivot.
struct EffectiveEdge {
  std::array<Index, 4> dofs{};
  Pivot first;
  Pivot last;

  [[nodiscard]] bool has_pivot() const { return first.distance != 0.0 || last.distance != 0.0; }
  /// The vector [m] where the tangents are turned by `first_turn` and `last_turn` [rad].
  [[nodiscard]] Vec2 vector(const Vector& positions, double first_turn, double last_turn) const {
    return Vec2(positions[dofs[2]], positions[dofs[3]]) + last.offset(last_turn) -
           Vec2(positions[dofs[0]], positions[dofs[1]]) - first.offset(first_turn);
  }
  [[nodiscard]] Vec2 vector(const Configuration& here) const {
    return vector(here.coordinates, first.turn(here.controls), last.turn(here.controls));
  }
  /// The vector [m] in the initial shape, where no clamp has turned yet.
  [[nodiscard]] Vec2 drawn(const Vector& positions) const { return vector(positions, 0.0, 0.0); }
};

}  // namespace der
