#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "der/core/lanes.hpp"
#include "der/core/static_for.hpp"
#include "der/kinematics/curvature_measure.hpp"

namespace der {

/// Length of the curvature binormal as a function of d = ta . tb, the cosine of the turning angle
/// between the unit tangents of two edges: kb = f(d) ta x tb (Bergou et al. 2008, eq. 1).
template <class T>
struct BinormalFactor {
  T f = 1.0;
  T log_slope = 0.0;   ///< f'/f
  T log_change = 0.0;  ///< (f'/f)' - (f'/f)^2
};

template <class Curvature>
struct Binormal;

/// |kb| = 2 tan(phi/2): f = 2/(1 + d).
template <>
struct Binormal<TangentCurvature> {
  template <class T>
  static BinormalFactor<T> of(const T& d) {
    const T half = 1.0 / (1.0 + d);
    return {2.0 * half, -half, 0.0};
  }
};

/// |kb| = phi: f = acos(d)/sqrt(1 - d^2). With u = 1 - d and k = (f - 1 - u/3)/u^2, a power series
/// in u, neither f nor its derivatives cancel at d = 1; they follow from
/// (1 - d^2) f' = d f - 1.
template <>
struct Binormal<AngleCurvature> {
  template <class T>
  static BinormalFactor<T> of(const T& d) {
    const T u = 1.0 - d;
    const T k = second_quotient(u);
    const T f = 1.0 + u * (1.0 / 3.0 + u * k);
    const T half = 1.0 / (2.0 - u);
    const T first = (-2.0 / 3.0 - u * (1.0 / 3.0) + u * k * (1.0 - u)) * half;
    const T second = (2.0 / 3.0 * (1.0 + u) + k * (3.0 - u * (4.0 - 2.0 * u))) * half * half;
    const T slope = first / f;
    return {f, slope, second / f - 2.0 * slope * slope};
  }

 private:
  static constexpr double kSmall = 0.125;

  /// f = sum of c_n u^n. These are c_{n+1}/c_n = (n + 1)/(2 n + 3) for n = 14 .. 2.
  static constexpr std::array<double, 13> kQuotients = [] {
    std::array<double, 13> quotients{};
    for (std::size_t i = 0; i < quotients.size(); ++i) {
      const double n = 14.0 - static_cast<double>(i);
      quotients[i] = (n + 1.0) / (2.0 * n + 3.0);
    }
    return quotients;
  }();

  /// The terms of f from n = 2 on, over u^2.
  template <class T>
  static T series(const T& u) {
    T sum = 1.0;
    for_each_constant(kQuotients, [&](double quotient) { sum = 1.0 + sum * u * quotient; });
    return 2.0 / 15.0 * sum;
  }
  template <class T>
  static T second_quotient(const T& u) {
    if (all_less<T>(u, kSmall)) return series(u);
    if constexpr (LaneTraits<T>::kCount == 1) {
      const double f = std::acos(std::max(-1.0, 1.0 - u)) / std::sqrt(u * (2.0 - u));
      return (f - 1.0 - u / 3.0) / (u * u);
    } else {
      return in_lanes<T>([&](int lane) { return second_quotient(u.lane(lane)); });
    }
  }
};

}  // namespace der
