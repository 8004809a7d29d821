#pragma once

#include <cmath>

#include "der/core/two_lanes.hpp"

namespace der {

template <class T>
struct SineAndCosine {
  T sine;
  T cosine;
};

/// For |x| <= pi/4: power series, exact to rounding.
template <class T>
SineAndCosine<T> small_sine_and_cosine(const T& x) {
  const T u = x * x;
  T sine = 1.0;
  T cosine = 1.0;
  for (const double n : {17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0}) {
    sine = 1.0 - u * (1.0 / (n * (n - 1.0))) * sine;
    cosine = 1.0 - u * (1.0 / ((n - 1.0) * (n - 2.0))) * cosine;
  }
  return {x * sine, cosine};
}

/// Most angles of a rod's sections are small: there the series are several times faster than the
/// library.
inline SineAndCosine<double> sine_and_cosine(double x) {
  constexpr double eighth_turn = 0.785398163397448;
  if (std::abs(x) < eighth_turn) return small_sine_and_cosine(x);
  return {std::sin(x), std::cos(x)};
}
inline SineAndCosine<TwoLanes> sine_and_cosine(const TwoLanes& x) {
  constexpr double eighth_turn = 0.785398163397448;
  if (std::abs(x.lane(0)) < eighth_turn && std::abs(x.lane(1)) < eighth_turn) {
    return small_sine_and_cosine(x);
  }
  const auto [sine_0, cosine_0] = sine_and_cosine(x.lane(0));
  const auto [sine_1, cosine_1] = sine_and_cosine(x.lane(1));
  return {{sine_0, sine_1}, {cosine_0, cosine_1}};
}

}  // namespace der
