#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/direction_angle.hpp"

namespace der {

/// Rotates a planar vector by +90 degrees.
inline Vec2 perpendicular(const Vec2& v) { return {-v.y(), v.x()}; }

/// z component of the cross product of two planar vectors.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Signed angle from `a` to `b`, in (-pi, pi]; lengths do not matter.
inline double angle_between(const Vec2& a, const Vec2& b) {
  return direction_angle(a.dot(b), cross(a, b));
}

/// Gradient [1/m] of the direction angle of a planar edge vector `e`: perpendicular(e) / |e|^2.
inline Vec2 direction_gradient(const Vec2& e, double inverse_squared_length) {
  return inverse_squared_length * perpendicular(e);
}

/// Hessian [1/m^2] of the direction angle of a planar edge vector `e`, with `gradient` from above:
/// -(t n' + n t') / |e|^2, t and n the unit tangent and normal. Symmetric and traceless.
inline Mat2 direction_hessian(const Vec2& e, const Vec2& gradient, double inverse_squared_length) {
  const double xx = -2.0 * inverse_squared_length * e.x() * gradient.x();
  const double xy = -inverse_squared_length * (e.x() * gradient.y() + e.y() * gradient.x());
  Mat2 hessian;
  hessian << xx, xy, xy, -xx;
  return hessian;
}

}  // namespace der
