#pragma once

#include "der/core/types.hpp"

namespace der {

/// A vector of the plane as one in space.
inline Vec3 in_space(const Vec2& vector) { return {vector.x(), vector.y(), 0.0}; }

}  // namespace der
