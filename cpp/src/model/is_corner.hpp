#pragma once

#include <cmath>

#include "der/kinematics/section_frame.hpp"

namespace der {

/// Whether two edges are drawn with a corner between them: a smooth curve on a mesh that resolves
/// it turns by less.
inline bool is_corner(const SectionFrame& before, const SectionFrame& after) {
  constexpr double turn = 0.5;  // [rad]
  return before.tangent.cross(after.tangent).norm() > std::sin(turn) ||
         before.tangent.dot(after.tangent) < 0.0;
}

}  // namespace der
