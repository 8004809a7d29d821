#pragma once

#include <array>

#include "der/core/types.hpp"

namespace der {

/// A moment [N m] on a rod, and what each of the one or two edges that it turns takes of it.
struct EdgeMoments {
  Vec3 whole = Vec3::Zero();
  std::array<Vec3, 2> on_edge{Vec3::Zero(), Vec3::Zero()};
};

}  // namespace der
