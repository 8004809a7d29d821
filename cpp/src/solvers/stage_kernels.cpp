#include "stage_kernels.hpp"

#include <algorithm>
#include <cstring>

#include "der/core/processor.hpp"

namespace der {
namespace {

/// |x| as the integer of the same bits: these integers have the order of the magnitudes, with all
/// that is not a number above infinity. Compilers vectorize their maximum, but not that of doubles.
std::int64_t magnitude(double x) {
  std::int64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return bits & kCounts;
}

double number(std::int64_t magnitude) {
  double x = 0.0;
  std::memcpy(&x, &magnitude, sizeof x);
  return x;
}

// The loops see plain arrays that do not overlap.

DER_FOR_EACH_PROCESSOR
double largest_of(Index size, const double* x) {
  std::int64_t largest = 0;
  for (Index i = 0; i < size; ++i) largest = std::max(largest, magnitude(x[i]));
  return number(largest);
}

DER_FOR_EACH_PROCESSOR
double largest_of(Index size, const double* x, const std::int64_t* counts) {
  std::int64_t largest = 0;
  for (Index i = 0; i < size; ++i) largest = std::max(largest, magnitude(x[i]) & counts[i]);
  return number(largest);
}

DER_FOR_EACH_PROCESSOR
double subtract(Index size, const double* __restrict force, double* __restrict residual) {
  std::int64_t largest = 0;
  for (Index i = 0; i < size; ++i) {
    largest = std::max(largest, magnitude(residual[i]));
    residual[i] -= force[i];
  }
  return number(largest);
}

DER_FOR_EACH_PROCESSOR
double add_inertia(Index size, double factor, const double* __restrict lumped,
                   const double* __restrict displacement, const double* __restrict target,
                   double* __restrict acceleration, double* __restrict residual) {
  std::int64_t largest = 0;
  for (Index i = 0; i < size; ++i) {
    const double a = factor * (displacement[i] - target[i]);
    const double force = lumped[i] * a;
    acceleration[i] = a;
    residual[i] += force;
    largest = std::max(largest, magnitude(force));
  }
  return number(largest);
}

}  // namespace

double largest_magnitude(const Vector& x) {
  return largest_of(static_cast<Index>(x.size()), x.data());
}

double largest_magnitude(const Vector& x, const CountMask& counts) {
  return largest_of(static_cast<Index>(x.size()), x.data(), counts.data());
}

double subtract_force(const Vector& force, Vector& residual) {
  return subtract(static_cast<Index>(residual.size()), force.data(), residual.data());
}

double add_lumped_inertia(double factor, const Vector& lumped, const Vector& displacement,
                          const Vector& target, Vector& acceleration, Vector& residual) {
  return add_inertia(static_cast<Index>(residual.size()), factor, lumped.data(),
                     displacement.data(), target.data(), acceleration.data(), residual.data());
}

}  // namespace der
