#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <tuple>

#include "der/core/lanes.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/direction_angle.hpp"
#include "der/kinematics/sine_and_cosine.hpp"

namespace der {

/// The orthonormal frame of a cross-section: `first` along its width, `second` = tangent x first
/// along its height.
template <class T>
struct SectionFrameOf {
  Vector3<T> tangent = Vector3<T>::UnitX();
  Vector3<T> first = Vector3<T>::UnitY();
  Vector3<T> second = Vector3<T>::UnitZ();

  auto fields() { return std::tie(tangent, first, second); }
  /// `first` has to be a unit vector across the unit `tangent`.
  static SectionFrameOf of(const Vector3<T>& tangent, const Vector3<T>& first) {
    return {tangent, first, tangent.cross(first)};
  }
  /// The frame turned about its tangent by `angle` [rad].
  [[nodiscard]] SectionFrameOf turned(const T& angle) const {
    const auto [sine, cosine] = sine_and_cosine(angle);
    return {tangent, cosine * first + sine * second, cosine * second - sine * first};
  }
};
using SectionFrame = SectionFrameOf<double>;

/// The axes about which a section turns towards its two directors and about its tangent: bending
/// towards a director turns about the other one.
inline Mat3 turning_axes(const SectionFrame& section) {
  Mat3 axes;
  axes << section.second, -section.first, section.tangent;
  return axes;
}

/// Parallel transport of `v` from the unit tangent `from` to the unit tangent `to`: the smallest
/// rotation that takes one to the other (Bergou et al. 2008, section 4.1). Not defined where the
/// two are opposite.
template <class T>
Vector3<T> transport(const Vector3<T>& v, const Vector3<T>& from, const Vector3<T>& to) {
  const Vector3<T> axis = from.cross(to);
  const T cosine = from.dot(to);
  return cosine * v + axis.cross(v) + axis.dot(v) / (1.0 + cosine) * axis;
}

/// v / |v|.
inline Vec3 unit_vector(const Vec3& v) { return v.normalized(); }
template <int N>
Vector3<Lanes<N>> unit_vector(const Vector3<Lanes<N>>& v) {
  return v / v.norm();
}

/// A component of the unit vector `v` across the unit `tangent`, as a unit vector.
template <class T>
Vector3<T> made_perpendicular(const Vector3<T>& v, const Vector3<T>& tangent) {
  return unit_vector(Vector3<T>(v - v.dot(tangent) * tangent));
}
inline Vec3 made_perpendicular(const Vec3& v, const Vec3& tangent) {
  return made_perpendicular<double>(v, tangent);
}

/// Angle [rad] about the tangent of `after` by which its section is turned against that of
/// `before`, once that is transported to it; in (-pi, pi].
template <class T>
T twist_between(const SectionFrameOf<T>& before, const SectionFrameOf<T>& after) {
  const Vector3<T> moved = transport<T>(before.first, before.tangent, after.tangent);
  return direction_angle(T(moved.dot(after.first)), T(-moved.dot(after.second)));
}

/// The value that differs from `angle` by whole turns and is next to `near` [rad].
inline double nearest_turn(double angle, double near) {
  constexpr double turn = 6.283185307179586;
  return angle - turn * std::nearbyint((angle - near) / turn);
}
template <int N>
Lanes<N> nearest_turn(const Lanes<N>& angle, const Lanes<N>& near) {
  return in_lanes<Lanes<N>>(
      [&](int lane) { return nearest_turn(angle.lane(lane), near.lane(lane)); });
}

}  // namespace der
