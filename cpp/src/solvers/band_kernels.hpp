#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

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

/// Takes off `entries`, those of a column so far, what they lose to the column `distance` before
/// it, and leaves that one's multiplier in its place; returns it. Entries in the band are `step`
/// apart.
template <class T>
T take_off(Index distance, Index width, Index step, T* column, T* entries) {
  T* const other = column - static_cast<std::ptrdiff_t>(distance) * (width + 1) * step;
  const T entry = other[distance * step];
  const T multiplier = entry * other[0];
  other[distance * step] = multiplier;
  entries[0] -= multiplier * entry;
  for (Index i = 1; i + distance <= width; ++i) {
    entries[i] -= multiplier * other[(distance + i) * step];
  }
  return multiplier;
}

/// Finishes a column but for the division: takes off what it loses to those `farthest` to `nearest`
/// before it, the farthest first, and calls also(distance, multiplier) for each. Unrolled, so that
/// its entries stay in registers. Returns the first.
template <Index kWidth, Index kStep, class T, class Also, Index... kBehind>
T finish_column(Index farthest, Index nearest, T* column, const Also& also,
                std::integer_sequence<Index, kBehind...> /*columns*/) {
  std::array<T, to_size(kWidth) + 1> entries;
  for (Index i = 0; i <= kWidth; ++i) entries[to_size(i)] = column[i * kStep];
  const auto take = [&](Index distance) {
    if (distance > farthest || distance < nearest) return;
    also(distance, take_off(distance, kWidth, kStep, column, entries.data()));
  };
  (take(kWidth - kBehind), ...);
  for (Index i = 0; i <= kWidth; ++i) column[i * kStep] = entries[to_size(i)];
  return entries[0];
}

/// Where a right side is not eliminated along with its matrix.
struct NoRightSide {};

/// Turns `size` columns into 1/d_j and the multipliers l_{j+1,j} .., and eliminates them from those
/// behind. Each column is read and written once, when all before it are done: memory takes fewer
/// writes than numbers. `kMatrices` lie side by side, entry by entry. `pivots.take(column, pivot)`
/// sees every pivot and says whether to go on. A right side, a T* with as many numbers side by
/// side, is left as `eliminate` leaves it: the multipliers are at hand.
template <Index kWidth, Index kMatrices, class T, class Pivots, class RightSide>
void factorize_band(Index size, T* band, Pivots& pivots, RightSide right_side) {
  constexpr std::make_integer_sequence<Index, kWidth> distances;
  for (Index j = 0; j < size + kWidth; ++j) {
    for (Index matrix = 0; matrix < kMatrices; ++matrix) {
      T* const column = band + static_cast<std::ptrdiff_t>(j) * (kWidth + 1) * kMatrices + matrix;
      const auto finish = [&](Index farthest, Index nearest) {
        if constexpr (std::is_same_v<RightSide, NoRightSide>) {
          const auto nothing = [](Index /*distance*/, const T& /*multiplier*/) {};
          return finish_column<kWidth, kMatrices>(farthest, nearest, column, nothing, distances);
        } else {
          T* const entry = right_side + static_cast<std::ptrdiff_t>(j) * kMatrices + matrix;
          T value = *entry;
          const auto eliminate_entry = [&](Index distance, const T& multiplier) {
            value -= multiplier * entry[-distance * kMatrices];
          };
          const T pivot = finish_column<kWidth, kMatrices>(farthest, nearest, column,
                                                           eliminate_entry, distances);
          *entry = value;
          return pivot;
        }
      };
      if (j >= size) {
        finish(j, j - size + 1);
        continue;
      }
      const T pivot = j < kWidth ? finish(j, 1) : finish(kWidth, 1);
      if (!pivots.take(j, pivot)) return;
      column[0] = 1.0 / pivot;
    }
  }
}

/// The same for a width that is only known at run time: each column is eliminated from those behind
/// as soon as it is done, in loops over neighbouring numbers. `scratch` has room for a column.
template <class T, class Pivots>
void factorize_band(Index size, Index width, T* band, T* scratch, Pivots& pivots) {
  for (Index j = 0; j < size; ++j) {
    T* column = band + static_cast<std::ptrdiff_t>(j) * (width + 1);
    const T pivot = column[0];
    if (!pivots.take(j, pivot)) return;
    const T inverse = 1.0 / pivot;
    column[0] = inverse;
    // A copy, as the compiler would have to read the column again after every write behind it.
    std::copy_n(column + 1, width, scratch);
    for (Index k = 1; k <= width; ++k) {
      const T multiplier = scratch[k - 1] * inverse;
      column[k] = multiplier;
      T* target = column + static_cast<std::ptrdiff_t>(k) * (width + 1);
      for (Index m = k; m <= width; ++m) target[m - k] -= multiplier * scratch[m - 1];
    }
  }
}

/// The band kernels of BandedLdlt and TwistedLdlt: `kWidth` is the half-bandwidth, or 0.
template <Index kWidth, class T>
Inertia factorize_band(Index size, Index run_time_width, T* band, T* scratch) {
  PivotCount<T> pivots;
  if constexpr (kWidth > 0) {
    factorize_band<kWidth, 1>(size, band, pivots, NoRightSide{});
  } else {
    factorize_band(size, run_time_width, band, scratch, pivots);
  }
  return pivots.inertia();
}

/// Takes the multiples of `size` columns off the entries of `b` behind each.
template <Index kWidth, class T>
void eliminate(Index size, Index run_time_width, const T* band, T* b) {
  const Index width = kWidth > 0 ? kWidth : run_time_width;
  for (Index j = 0; j < size; ++j) {
    const T* column = band + static_cast<std::ptrdiff_t>(j) * (width + 1);
    const T y = b[j];
    for (Index k = 1; k <= width; ++k) b[j + k] -= column[k] * y;
  }
}

/// Divides the `size` first entries of `b`, from which columns have been eliminated, by d_j and
/// solves for them, the `width` behind them being known.
template <Index kWidth, class T>
void substitute(Index size, Index run_time_width, const T* band, T* b) {
  const Index width = kWidth > 0 ? kWidth : run_time_width;
  for (Index j = size - 1; j >= 0; --j) {
    const T* column = band + static_cast<std::ptrdiff_t>(j) * (width + 1);
    T x = b[j] * column[0];
    // From the far end: the value needed last is the one computed last.
    for (Index k = width; k >= 1; --k) x -= column[k] * b[j + k];
    b[j] = x;
  }
}

}  // namespace der
