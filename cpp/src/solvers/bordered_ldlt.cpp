#include "der/solvers/bordered_ldlt.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "der/core/index.hpp"
#include "der/core/loops.hpp"

namespace der {
namespace {

using BorderedColumns = BorderedLdlt::Columns;

/// Stands for a half-bandwidth or a stride that is only known at run time.
constexpr Index kAny = -1;

/// An array of a length that is known, in registers, or of `scratch`.
template <Index kSize>
struct Local {
  std::array<double, to_size(kSize)> values{};
  explicit Local(double* /*scratch*/) {}
  double* data() { return values.data(); }
};
template <>
struct Local<kAny> {
  double* values;
  explicit Local(double* scratch) : values(scratch) {}
  [[nodiscard]] double* data() const { return values; }
};

template <Index kWidth, Index kStride>
Inertia factorize(const BorderedColumns& columns, Index any_width, Index any_stride, double* band,
                  double* border, double* corner, double* scratch) {
  const Index width = kWidth == kAny ? any_width : kWidth;
  const Index stride = kStride == kAny ? any_stride : kStride;
  // The current column: copies, as the compiler would have to read the column again after every
  // write to those behind it.
  Local<kWidth> column_entries(scratch);
  Local<kStride> border_entries(scratch + width);
  double* const entries = column_entries.data();
  double* const rows = border_entries.data();
  Inertia inertia;
  double* column = band + static_cast<std::ptrdiff_t>(columns.first) * (width + 1);
  double* tail = border + columns.border_start;
  for (Index j = columns.first; j < columns.end; ++j, column += width + 1, tail += stride) {
    const double pivot = column[0];
    if (!(std::abs(pivot) > 0.0) || !std::isfinite(pivot)) {
      inertia.failed_at = j;
      return inertia;
    }
    inertia.negative_pivots += pivot < 0.0 ? 1 : 0;
    const double inverse = 1.0 / pivot;
    column[0] = inverse;
    std::copy_n(column + 1, width, entries);
    std::copy_n(tail, stride, rows);
    for (Index k = 1; k <= width; ++k) {
      const double multiplier = entries[k - 1] * inverse;
      column[k] = multiplier;
      double* target = column + k * (width + 1);
      for (Index m = k; m <= width; ++m) target[m - k] -= multiplier * entries[m - 1];
      double* target_rows = tail + k * stride;
      for (Index r = 0; r < stride; ++r) target_rows[r] -= multiplier * rows[r];
    }
    for (Index r = 0; r < stride; ++r) {
      const double multiplier = rows[r] * inverse;
      tail[r] = multiplier;
      for (Index q = 0; q < stride; ++q) corner[r * stride + q] -= multiplier * rows[q];
    }
  }
  inertia.factorised = true;
  return inertia;
}

template <Index kWidth, Index kStride>
void forward(const BorderedColumns& columns, Index any_width, Index any_stride, const double* band,
             const double* border, double* b) {
  const Index width = kWidth == kAny ? any_width : kWidth;
  const Index stride = kStride == kAny ? any_stride : kStride;
  const double* column = band + static_cast<std::ptrdiff_t>(columns.first) * (width + 1);
  const double* tail = border + columns.border_start;
  double* const rows = b + columns.border_row;
  for (Index j = columns.first; j < columns.end; ++j, column += width + 1, tail += stride) {
    const double y = b[j];
    for (Index k = 1; k <= width; ++k) b[j + k] -= column[k] * y;
    for (Index r = 0; r < columns.border_rows; ++r) rows[r] -= tail[r] * y;
    b[j] = y * column[0];
  }
}

template <Index kWidth, Index kStride>
void backward(const BorderedColumns& columns, Index any_width, Index any_stride, const double* band,
              const double* border, double* b) {
  const Index width = kWidth == kAny ? any_width : kWidth;
  const Index stride = kStride == kAny ? any_stride : kStride;
  const auto count = static_cast<std::ptrdiff_t>(columns.end - columns.first);
  const double* column = band + static_cast<std::ptrdiff_t>(columns.end) * (width + 1);
  const double* tail = border + columns.border_start + count * stride;
  const double* const rows = b + columns.border_row;
  for (Index j = columns.end - 1; j >= columns.first; --j) {
    column -= width + 1;
    tail -= stride;
    double x = b[j];
    for (Index r = 0; r < columns.border_rows; ++r) x -= tail[r] * rows[r];
    // From the far end: the value needed last is the one computed last.
    for (Index k = width; k >= 1; --k) x -= column[k] * b[j + k];
    b[j] = x;
  }
}

// The usual widths are innermost loops.
template <Index kWidth, Index kStride>
Inertia factorize_ring(const BorderedColumns& columns, Index /*width*/, Index /*stride*/,
                       double* band, double* border, double* corner, double* scratch) {
  return dispatch_simd([&] {
    return factorize<kWidth, kStride>(columns, kWidth, kStride, band, border, corner, scratch);
  });
}
template <Index kWidth, Index kStride>
void forward_ring(const BorderedColumns& columns, Index /*width*/, Index /*stride*/,
                  const double* band, const double* border, double* b) {
  dispatch_simd([&] { forward<kWidth, kStride>(columns, kWidth, kStride, band, border, b); });
}
template <Index kWidth, Index kStride>
void backward_ring(const BorderedColumns& columns, Index /*width*/, Index /*stride*/,
                   const double* band, const double* border, double* b) {
  dispatch_simd([&] { backward<kWidth, kStride>(columns, kWidth, kStride, band, border, b); });
}
template <Index kWidth, Index kStride>
constexpr BorderedLdlt::Kernels kRingKernels{
    factorize_ring<kWidth, kStride>, forward_ring<kWidth, kStride>, backward_ring<kWidth, kStride>};

BorderedLdlt::Kernels kernels_of(Index width, Index stride) {
  if (width == 5 && stride == 4) return kRingKernels<5, 4>;    // rings in the plane
  if (width == 8 && stride == 8) return kRingKernels<8, 8>;    // rings in space
  if (width == 10 && stride == 8) return kRingKernels<10, 8>;  // the same with angles of sections
  return {factorize<kAny, kAny>, forward<kAny, kAny>, backward<kAny, kAny>};
}

}  // namespace

BorderedLdlt::BorderedLdlt(const Pattern& pattern)
    : size_(pattern.size),
      half_bandwidth_(pattern.half_bandwidth),
      layout_(MatrixLayout::bordered_band(pattern)) {
  Index next = 0;
  Index stored = 0;
  Index widest = 0;
  for (const Border& border : pattern.borders) {
    const Index stride = MatrixLayout::border_stride(border);
    if (next < border.first_column) add_part({next, border.first_column, 0, 0, 0}, 0);
    add_part({border.first_column, border.first_row, border.first_row, border.rows(), stored},
             stride);
    next = border.first_row;
    stored += border.columns() * stride;
    widest = std::max(widest, stride);
  }
  add_part({next, size_, 0, 0, 0}, 0);
  band_.setZero(static_cast<Eigen::Index>(size_ + half_bandwidth_) * (half_bandwidth_ + 1));
  border_.setZero(stored + half_bandwidth_ * widest);
  corner_.setZero(static_cast<Eigen::Index>(widest) * widest);
  scratch_.setZero(half_bandwidth_ + widest);
  right_side_.setZero(size_ + half_bandwidth_);
}

void BorderedLdlt::add_part(const Columns& columns, Index stride) {
  parts_.push_back({columns, stride, kernels_of(half_bandwidth_, stride)});
}

Inertia BorderedLdlt::factorize(const Vector& values) {
  const auto used = static_cast<Eigen::Index>(size_) * (half_bandwidth_ + 1);
  band_.head(used) = values.head(used);
  band_.tail(band_.size() - used).setZero();
  Inertia inertia;
  for (const Part& part : parts_) {
    const auto& [first, end, border_row, border_rows, border_start] = part.columns;
    const Index stride = part.stride;
    // Beyond its last column the elimination reaches into the border of the next ring, which is
    // therefore read after it.
    const Index stored = (end - first) * stride;
    border_.segment(border_start, stored) = values.segment(used + border_start, stored);
    border_.segment(border_start + stored, half_bandwidth_ * stride).setZero();
    corner_.setZero();
    const Inertia own = part.kernels.factorize(part.columns, half_bandwidth_, stride, band_.data(),
                                               border_.data(), corner_.data(), scratch_.data());
    inertia.negative_pivots += own.negative_pivots;
    inertia.failed_at = own.failed_at;
    if (!own.factorised) return inertia;
    for (Index column = 0; column < border_rows; ++column) {
      double* target =
          band_.data() + static_cast<std::ptrdiff_t>(border_row + column) * (half_bandwidth_ + 1);
      for (Index row = column; row < border_rows; ++row) {
        target[row - column] += corner_[row * stride + column];
      }
    }
  }
  inertia.factorised = true;
  return inertia;
}

void BorderedLdlt::solve(Vector& b) {
  right_side_.head(size_) = b;
  right_side_.tail(half_bandwidth_).setZero();
  for (const Part& part : parts_) {
    part.kernels.forward(part.columns, half_bandwidth_, part.stride, band_.data(), border_.data(),
                         right_side_.data());
  }
  for (auto part = parts_.rbegin(); part != parts_.rend(); ++part) {
    part->kernels.backward(part->columns, half_bandwidth_, part->stride, band_.data(),
                           border_.data(), right_side_.data());
  }
  b = right_side_.head(size_);
}

}  // namespace der
