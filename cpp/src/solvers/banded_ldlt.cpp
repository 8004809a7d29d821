#include "der/solvers/banded_ldlt.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "der/core/index.hpp"
#include "der/core/processor.hpp"

namespace der {
namespace {

/// `kWidth` is the half-bandwidth, or 0 when it is only known at run time.
template <Index kWidth>
Inertia factorize_band(Index size, Index run_time_width, double* band, double* scratch) {
  const Index width = kWidth > 0 ? kWidth : run_time_width;
  const Index stride = width + 1;
  // The current column: a copy, in registers where its length is known, as the compiler would have
  // to read the column again after every write to those behind it.
  std::array<double, to_size(kWidth)> registers;
  double* const entries = kWidth > 0 ? registers.data() : scratch;
  Inertia inertia;
  for (Index j = 0; j < size; ++j) {
    double* column = band + static_cast<std::ptrdiff_t>(j) * stride;
    const double pivot = column[0];
    if (!(std::abs(pivot) > 0.0) || !std::isfinite(pivot)) {
      inertia.failed_at = j;
      return inertia;
    }
    inertia.negative_pivots += pivot < 0.0 ? 1 : 0;
    const double inverse = 1.0 / pivot;
    column[0] = inverse;
    std::copy_n(column + 1, width, entries);
    for (Index k = 1; k <= width; ++k) {
      const double multiplier = entries[k - 1] * inverse;
      column[k] = multiplier;
      double* target = column + k * stride;
      for (Index m = k; m <= width; ++m) target[m - k] -= multiplier * entries[m - 1];
    }
  }
  inertia.factorised = true;
  return inertia;
}

template <Index kWidth>
void solve_band(Index size, Index run_time_width, const double* band, double* b) {
  const Index width = kWidth > 0 ? kWidth : run_time_width;
  const Index stride = width + 1;
  for (Index j = 0; j < size; ++j) {
    const double* column = band + static_cast<std::ptrdiff_t>(j) * stride;
    const double y = b[j];
    for (Index k = 1; k <= width; ++k) b[j + k] -= column[k] * y;
    b[j] = y * column[0];
  }
  for (Index j = size - 1; j >= 0; --j) {
    const double* column = band + static_cast<std::ptrdiff_t>(j) * stride;
    double x = b[j];
    // From the far end: the value needed last is the one computed last.
    for (Index k = width; k >= 1; --k) x -= column[k] * b[j + k];
    b[j] = x;
  }
}

// Planar chains.
DER_FOR_EACH_PROCESSOR
Inertia factorize_band_5(Index size, Index /*width*/, double* band, double* scratch) {
  return factorize_band<5>(size, 5, band, scratch);
}
DER_FOR_EACH_PROCESSOR
void solve_band_5(Index size, Index /*width*/, const double* band, double* b) {
  solve_band<5>(size, 5, band, b);
}
// Chains in space without and with angles of sections.
DER_FOR_EACH_PROCESSOR
Inertia factorize_band_8(Index size, Index /*width*/, double* band, double* scratch) {
  return factorize_band<8>(size, 8, band, scratch);
}
DER_FOR_EACH_PROCESSOR
void solve_band_8(Index size, Index /*width*/, const double* band, double* b) {
  solve_band<8>(size, 8, band, b);
}
DER_FOR_EACH_PROCESSOR
Inertia factorize_band_10(Index size, Index /*width*/, double* band, double* scratch) {
  return factorize_band<10>(size, 10, band, scratch);
}
DER_FOR_EACH_PROCESSOR
void solve_band_10(Index size, Index /*width*/, const double* band, double* b) {
  solve_band<10>(size, 10, band, b);
}

}  // namespace

BandedLdlt::BandedLdlt(const Pattern& pattern)
    : size_(pattern.size),
      half_bandwidth_(pattern.half_bandwidth),
      layout_(MatrixLayout::band(pattern.size, pattern.half_bandwidth)),
      factorize_kernel_(factorize_band<0>),
      solve_kernel_(solve_band<0>) {
  if (half_bandwidth_ == 5) {
    factorize_kernel_ = factorize_band_5;
    solve_kernel_ = solve_band_5;
  } else if (half_bandwidth_ == 8) {
    factorize_kernel_ = factorize_band_8;
    solve_kernel_ = solve_band_8;
  } else if (half_bandwidth_ == 10) {
    factorize_kernel_ = factorize_band_10;
    solve_kernel_ = solve_band_10;
  } else if (half_bandwidth_ == 2) {  // their mass matrix
    factorize_kernel_ = factorize_band<2>;
    solve_kernel_ = solve_band<2>;
  }
  band_.setZero(static_cast<Eigen::Index>(size_ + half_bandwidth_) * (half_bandwidth_ + 1));
  right_side_.setZero(size_ + half_bandwidth_);
  scratch_.setZero(half_bandwidth_);
}

Inertia BandedLdlt::factorize(const Vector& values) {
  const Index used = layout_.num_values();
  band_.head(used) = values.head(used);
  band_.tail(band_.size() - used).setZero();
  return factorize_kernel_(size_, half_bandwidth_, band_.data(), scratch_.data());
}

void BandedLdlt::solve(Vector& b) {
  right_side_.head(size_) = b;
  right_side_.tail(half_bandwidth_).setZero();
  solve_kernel_(size_, half_bandwidth_, band_.data(), right_side_.data());
  b = right_side_.head(size_);
}

}  // namespace der
