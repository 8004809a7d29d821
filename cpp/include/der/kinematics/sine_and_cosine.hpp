#pragma once

#include <cmath>

#include "der/core/lanes.hpp"

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

constexpr double kEighthTurn = 0.785398163397448;

/// Most angles of a rod's sections are small: there the series are several times faster than the
/// library.
inline SineAndCosine<double> sine_and_cosine(double x) {
  if (std::abs(x) < kEighthTurn) return small_sine_and_cosine(x);
  return {std::sin(x), std::cos(x)};
}
template <int N>
SineAndCosine<Lanes<N>> sine_and_cosine(const Lanes<N>& x) {
  using T = Lanes<N>;
  const auto is_small = [&](int lane) { return std::abs(x.lane(lane)) < kEighthTurn; };
  if (in_all_lanes<T>(is_small)) return small_sine_and_cosine(x);
  return {in_lanes<T>([&](int lane) { return sine_and_cosine(x.lane(lane)).sine; }),
          in_lanes<T>([&](int lane) { return sine_and_cosine(x.lane(lane)).cosine; })};
}

}  // namespace der
