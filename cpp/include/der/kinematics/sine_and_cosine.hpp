#pragma once

#include <array>
#include <cmath>

#include "der/core/lanes.hpp"
#include "der/core/static_for.hpp"

namespace der {

template <class T>
struct SineAndCosine {
  T sine;
  T cosine;
};

/// Powers of the terms of the sine's series, the last one first.
constexpr std::array<double, 8> kSinePowers{17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0};
/// For |x| <= pi/4: power series, exact to rounding.
template <class T>
SineAndCosine<T> small_sine_and_cosine(const T& x) {
  const T u = x * x;
  T sine = 1.0;
  T cosine = 1.0;
  for_each_constant(kSinePowers, [&](double n) {
    sine = 1.0 - u * (1.0 / (n * (n - 1.0))) * sine;
    cosine = 1.0 - u * (1.0 / ((n - 1.0) * (n - 2.0))) * cosine;
  });
  return {x * sine, cosine};
}

constexpr double kEighthTurn = 0.785398163397448;

/// The integer next to |x| < 2^51.
template <class T>
T nearest_integer(const T& x) {
  constexpr double kNoFraction = 6755399441055744.0;  // 1.5 * 2^52
  return (x + kNoFraction) - kNoFraction;
}

/// For |x| < kManyTurns: the series at the rest that quarter turns leave (Cody and Waite, Software
/// Manual for the Elementary Functions, 1980), to rounding.
constexpr double kManyTurns = 1e5;
template <class T>
SineAndCosine<T> reduced_sine_and_cosine(const T& x) {
  // A quarter turn in three parts; the products with the first two are exact.
  constexpr double kPart1 = 1.57079632673412561417;
  constexpr double kPart2 = 6.07710050630396597660e-11;
  constexpr double kPart3 = 2.02226624879595063154e-21;
  const T quarters = nearest_integer<T>(x * 0.636619772367581343);
  const auto [s, c] =
      small_sine_and_cosine<T>(x - quarters * kPart1 - quarters * kPart2 - quarters * kPart3);
  // Half turns, an even number of them beside an odd quarter.
  const T halves = nearest_integer<T>(0.5 * quarters);
  const T odd = quarters - 2.0 * halves;
  const T parity = halves - 2.0 * nearest_integer<T>(0.5 * halves);
  const T sign = (1.0 - odd * odd) * (1.0 - 2.0 * parity * parity);
  return {sign * s + odd * c, sign * c - odd * s};
}

/// Most angles of a rod's sections are small: there the series are several times faster than the
/// library.
template <class T>
SineAndCosine<T> sine_and_cosine(const T& x) {
  using std::abs;
  const T size = abs(x);
  if (all_less<T>(size, kEighthTurn)) return small_sine_and_cosine(x);
  if (all_less<T>(size, kManyTurns)) return reduced_sine_and_cosine(x);
  if constexpr (LaneTraits<T>::kCount == 1) {
    return {std::sin(x), std::cos(x)};
  } else {
    return {T::of([&](int lane) { return sine_and_cosine(x.lane(lane)).sine; }),
            T::of([&](int lane) { return sine_and_cosine(x.lane(lane)).cosine; })};
  }
}

}  // namespace der
