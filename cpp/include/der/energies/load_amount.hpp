#pragma once

#include <array>

#include "der/core/types.hpp"
#include "der/kinematics/actuated_turn.hpp"

namespace der {

/// How actuations, and in a plane moments, turn the section that a load follows beyond its edges.
/// The vectors of a load in the initial shape, F0 and M0, are turned by it before the edges turn
/// them: the edges tell all that depends on coordinates.
struct ActuatedSection {
  ActuatedTurn turn;
  Mat3 axes = Mat3::Zero();  ///< of the drawn section (turning_axes), in a plane z stands first

  [[nodiscard]] Vec3 turned(const Vec3& vector, const Vector& controls) const;
};

/// How large a force [N] or a moment [N m] is.
struct LoadAmount {
  std::array<Index, 3> components{-1, -1, -1};  ///< their controls; -1: 0
  ActuatedSection actuated;                     ///< of loads that follow the rod

  [[nodiscard]] Vec3 at(const Vector& controls) const;
};

}  // namespace der
