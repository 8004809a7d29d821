#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "der/core/types.hpp"

namespace der {

/// The orthonormal frame of a cross-section: `first` along its width, `second` = tangent x first
/// along its height.
struct SectionFrame {
  Vec3 tangent = Vec3::UnitX();
  Vec3 first = Vec3::UnitY();
  Vec3 second = Vec3::UnitZ();

  /// `first` has to be a unit vector across the unit `tangent`.
  static SectionFrame of(const Vec3& tangent, const Vec3& first) {
    return {tangent, first, tangent.cross(first)};
  }
  /// The frame turned about its tangent by `angle` [rad].
  [[nodiscard]] SectionFrame turned(double angle) const {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    return {tangent, c * first + s * second, c * second - s * first};
  }
};

/// Parallel transport of `v` from the unit tangent `from` to the unit tangent `to`: the smallest
/// rotation that takes one to the other (Bergou et al. 2008, section 4.1). Not defined where the
/// two are opposite.
inline Vec3 transport(const Vec3& v, const Vec3& from, const Vec3& to) {
  const Vec3 axis = from.cross(to);
  const double cosine = from.dot(to);
  return cosine * v + axis.cross(v) + axis.dot(v) / (1.0 + cosine) * axis;
}

/// A component of the unit vector `v` across the unit `tangent`, as a unit vector.
inline Vec3 made_perpendicular(const Vec3& v, const Vec3& tangent) {
  return (v - v.dot(tangent) * tangent).normalized();
}

/// Angle [rad] about the tangent of `after` by which its section is turned against that of
/// `before`, once that is transported to it; in (-pi, pi].
inline double twist_between(const SectionFrame& before, const SectionFrame& after) {
  // first . transported first and first . transported second, up to the common factor of both:
  // tan of the sum and difference of two frames needs no transported vector.
  const Vec3 moved = transport(before.first, before.tangent, after.tangent);
  return std::atan2(moved.cross(after.first).dot(after.tangent), moved.dot(after.first));
}

/// The value that differs from `angle` by whole turns and is next to `near` [rad].
inline double nearest_turn(double angle, double near) {
  constexpr double turn = 6.283185307179586;
  return angle - turn * std::nearbyint((angle - near) / turn);
}

}  // namespace der
