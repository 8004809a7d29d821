#include "der/core/magnitude.hpp"

#include <algorithm>

#include "der/core/loops.hpp"

namespace der {
namespace {

// The loops see plain arrays.

double largest_in_loop(Index size, const double* x) {
  std::int64_t largest = 0;
  for (Index i = 0; i < size; ++i) largest = std::max(largest, magnitude_bits(x[i]));
  return magnitude_of(largest);
}

double largest_in_loop(Index size, const double* x, const std::int64_t* counts) {
  std::int64_t largest = 0;
  for (Index i = 0; i < size; ++i) largest = std::max(largest, magnitude_bits(x[i]) & counts[i]);
  return magnitude_of(largest);
}

}  // namespace

double largest_magnitude(Index size, const double* x) {
  return dispatch_simd([&] { return largest_in_loop(size, x); });
}

double largest_magnitude(Index size, const double* x, const std::int64_t* counts) {
  return dispatch_simd([&] { return largest_in_loop(size, x, counts); });
}

}  // namespace der
