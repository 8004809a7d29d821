#pragma once

#include <cstdint>
#include <cstring>

#include "der/core/types.hpp"

namespace der {

/// Masks the entries that a norm counts: kCounts for those that do, 0 for the others.
using CountMask = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;
constexpr std::int64_t kCounts = 0x7fff'ffff'ffff'ffff;

/// |x| as the integer of the same bits: these integers have the order of the magnitudes, with
/// NaN above infinity. Compilers vectorize their maximum, but not that of doubles.
inline std::int64_t magnitude_bits(double x) {
  std::int64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return bits & kCounts;
}

/// The magnitude of those bits.
inline double magnitude_of(std::int64_t bits) {
  double x = 0.0;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

/// Largest |x_i| of `size` values; NaN if one of them is NaN.
double largest_magnitude(Index size, const double* x);
/// Largest |x_i| of the values that count.
double largest_magnitude(Index size, const double* x, const std::int64_t* counts);
/// Largest |x_i| of a vector.
inline double largest_magnitude(const Vector& x) {
  return largest_magnitude(static_cast<Index>(x.size()), x.data());
}

}  // namespace der
