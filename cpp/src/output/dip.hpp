#pragma once

#include <limits>

#include "der/core/types.hpp"

namespace der {

/// The least length of the vectors on the line from one to another, where it passes by zero: the
/// two point away from each other. Infinity where it does not.
inline double min_norm_on_segment(const Vec3& first, const Vec3& last) {
  if (first.dot(last) >= 0.0) return std::numeric_limits<double>::infinity();
  const Vec3 way = last - first;
  return (first - first.dot(way) / way.squaredNorm() * way).norm();
}

}  // namespace der
