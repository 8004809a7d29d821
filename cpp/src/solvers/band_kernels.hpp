#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "der/core/index.hpp"
#include "der/core/lanes.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

// L D L^T of a band matrix, column by column: column j holds its entries of the rows j ..
// j + width. They are followed by `width` columns, into which the elimination of the last ones
// reaches. With two lanes, two matrices are factorised side by side.

/// Whether each lane of a pivot can be divided by.
template <class T>
bool is_pivot(const T& pivot) {
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    const double value = LaneTraits<T>::lane(pivot, lane);
    if (!(std::abs(value) > 0.0) || !std::isfinite(value)) return false;
  }
  return true;
}

/// Counts negative pivots; ends a factorisation at one that cannot be divided by.
template <class T>
class PivotCount {
 public:
  bool take(Index column, const T& pivot) {
    if (!is_pivot(pivot)) {
      inertia_.failed_at = column;
      return false;
    }
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      inertia_.negative_pivots += LaneTraits<T>::lane(pivot, lane) < 0.0 ? 1 : 0;
    }
    return true;
  }
  [[nodiscard]] Inertia inertia() const {
    Inertia result = inertia_;
    result.factorised = inertia_.failed_at < 0;
    return result;
  }

 private:
  Inertia inertia_;
};

/// Turns `size` columns into 1/d_j and the multipliers l_{j+1,j} .., and eliminates them from those
/// behind. `kWidth` is the half-bandwidth, or 0 when it is only known at run time; then `scratch`
/// has room for one column. `pivots.take(column, pivot)` sees every pivot and says whether to go
/// on.
template <Index kWidth, class T, class Pivots>
void factorize_band(Index size, Index run_time_width, T* band, T* scratch, Pivots& pivots) {
  const Index width = kWidth > 0 ? kWidth : run_time_width;
  const Index stride = width + 1;
  // The current column: a copy, in registers where its length is known, as the compiler would have
  // to read the column again after every write to those behind it.
  std::array<T, to_size(kWidth)> registers;
  T* const entries = kWidth > 0 ? registers.data() : scratch;
  for (Index j = 0; j < size; ++j) {
    T* column = band + static_cast<std::ptrdiff_t>(j) * stride;
    const T pivot = column[0];
    if (!pivots.take(j, pivot)) return;
    const T inverse = 1.0 / pivot;
    column[0] = inverse;
    for (Index k = 0; k < width; ++k) entries[k] = column[k + 1];
    for (Index k = 1; k <= width; ++k) {
      const T multiplier = entries[k - 1] * inverse;
      column[k] = multiplier;
      T* target = column + k * stride;
      for (Index m = k; m <= width; ++m) target[m - k] -= multiplier * entries[m - 1];
    }
  }
}
template <Index kWidth, class T>
Inertia factorize_band(Index size, Index run_time_width, T* band, T* scratch) {
  PivotCount<T> pivots;
  factorize_band<kWidth>(size, run_time_width, band, scratch, pivots);
  return pivots.inertia();
}

/// Takes the multiples of `size` columns off the entries of `b` behind each, and divides by d_j.
template <Index kWidth, class T>
void eliminate(Index size, Index run_time_width, const T* band, T* b) {
  const Index width = kWidth > 0 ? kWidth : run_time_width;
  for (Index j = 0; j < size; ++j) {
    const T* column = band + static_cast<std::ptrdiff_t>(j) * (width + 1);
    const T y = b[j];
    for (Index k = 1; k <= width; ++k) b[j + k] -= column[k] * y;
    b[j] = y * column[0];
  }
}

/// Solves for the `size` first entries of `b`, the `width` behind them being known.
template <Index kWidth, class T>
void substitute(Index size, Index run_time_width, const T* band, T* b) {
  const Index width = kWidth > 0 ? kWidth : run_time_width;
  for (Index j = size - 1; j >= 0; --j) {
    const T* column = band + static_cast<std::ptrdiff_t>(j) * (width + 1);
    T x = b[j];
    // From the far end: the value needed last is the one computed last.
    for (Index k = width; k >= 1; --k) x -= column[k] * b[j + k];
    b[j] = x;
  }
}

}  // namespace der
