#pragma once

#include <cmath>

#include "der/core/constants.hpp"
#include "der/core/lanes.hpp"

namespace der {

/// Arc tangent of t, |t| <= 1/8: ten terms of the series are exact to rounding.
template <class T>
T small_arc_tangent(const T& t) {
  const T u = t * t;
  constexpr double c1 = 1.0 / 3.0;
  constexpr double c2 = 1.0 / 5.0;
  constexpr double c3 = 1.0 / 7.0;
  constexpr double c4 = 1.0 / 9.0;
  constexpr double c5 = 1.0 / 11.0;
  constexpr double c6 = 1.0 / 13.0;
  constexpr double c7 = 1.0 / 15.0;
  constexpr double c8 = 1.0 / 17.0;
  constexpr double c9 = 1.0 / 19.0;
  const T tail = c5 - u * (c6 - u * (c7 - u * (c8 - u * c9)));
  return t - t * u * (c1 - u * (c2 - u * (c3 - u * (c4 - u * tail))));
}

/// Arc tangent of y / x, 0 <= y <= x; zero if both are. The series is that of the difference to the
/// nearest quarter, by tan(a - b) = (tan a - tan b) / (1 + tan a tan b).
template <class T>
T arc_tangent(const T& x, const T& y) {
  T tangent = 0.0;
  T angle = 0.0;
  // Constants are lanes from the start: GCC 12 makes them one by one otherwise.
  const auto pass = [&](const T& limit, const T& quarter, const T& its_angle) {
    const T bound = limit * x;
    tangent = if_less<T>(bound, 8.0 * y, quarter, tangent);
    angle = if_less<T>(bound, 8.0 * y, its_angle, angle);
  };
  pass(1.0, 0.25, 0.24497866312686415);
  pass(3.0, 0.5, 0.46364760900080612);
  pass(5.0, 0.75, 0.64350110879328439);
  pass(7.0, 1.0, 0.78539816339744831);
  const T denominator = x + tangent * y;
  return angle +
         small_arc_tangent(T((y - tangent * x) / if_less<T>(0.0, denominator, denominator, 1.0)));
}

/// Angle of the direction (x, y) from the x axis, in (-pi, pi]: to the last bit the same for all
/// number types. Most angles in a rod are small, and need the series alone.
template <class T>
T direction_angle(const T& x, const T& y) {
  using std::abs;
  const T width = abs(x);
  const T height = abs(y);
  if (all_less<T>(8.0 * height, x)) return small_arc_tangent(T(y / x));
  const T nearest = arc_tangent<T>(if_less<T>(width, height, height, width),
                                   if_less<T>(width, height, width, height));
  const T from_axis = if_less<T>(width, height, 0.5 * kPi - nearest, nearest);
  const T upward = if_less<T>(x, 0.0, kPi - from_axis, from_axis);
  return if_less<T>(y, 0.0, -upward, upward);
}

}  // namespace der
