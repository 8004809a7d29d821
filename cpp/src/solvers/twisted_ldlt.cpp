#include "der/solvers/twisted_ldlt.hpp"

#include "der/core/loops.hpp"
#include "solvers/band_kernels.hpp"

namespace der {
namespace {

template <Index kWidth>
Inertia factorize_halves(Index columns, TwoLanes* band) {
  TwoLanes* const none = nullptr;
  return dispatch_simd([&] { return factorize_band<kWidth>(columns, kWidth, band, none); });
}
template <Index kWidth>
void eliminate_halves(Index columns, const TwoLanes* band, TwoLanes* b) {
  dispatch_simd([&] { eliminate<kWidth>(columns, kWidth, band, b); });
}
template <Index kWidth>
void substitute_halves(Index columns, const TwoLanes* band, TwoLanes* b) {
  dispatch_simd([&] { substitute<kWidth>(columns, kWidth, band, b); });
}

// The middle is a full matrix of the band's width.
template <Index kWidth>
Inertia factorize_middle_of(double* band) {
  double* const none = nullptr;
  return dispatch_simd([&] { return factorize_band<kWidth>(kWidth, kWidth, band, none); });
}
template <Index kWidth>
void solve_middle_of(const double* band, double* b) {
  dispatch_simd([&] {
    eliminate<kWidth>(kWidth, kWidth, band, b);
    substitute<kWidth>(kWidth, kWidth, band, b);
  });
}

template <Index kWidth>
constexpr TwistedLdlt::Kernels kTwoEndedKernels{
    factorize_halves<kWidth>, eliminate_halves<kWidth>, substitute_halves<kWidth>,
    factorize_middle_of<kWidth>, solve_middle_of<kWidth>};

}  // namespace

TwistedLdlt::Kernels TwistedLdlt::kernels_of(Index half_bandwidth) {
  switch (half_bandwidth) {
    case 5:  // chains in the plane
      return kTwoEndedKernels<5>;
    case 6:  // the same with joints
      return kTwoEndedKernels<6>;
    case 7:  // and legs of two edges between them
      return kTwoEndedKernels<7>;
    case 8:  // chains in space
      return kTwoEndedKernels<8>;
    case 10:  // the same with angles of sections
      return kTwoEndedKernels<10>;
    default:
      return {};
  }
}

bool TwistedLdlt::suits(const Pattern& pattern) {
  return kernels_of(pattern.half_bandwidth).factorize != nullptr &&
         pattern.size >= 3 * pattern.half_bandwidth;
}

TwistedLdlt::TwistedLdlt(const Pattern& pattern)
    : size_(pattern.size),
      width_(pattern.half_bandwidth),
      columns_((size_ - width_ + 1) / 2),
      padding_((size_ - width_) % 2),
      layout_(MatrixLayout::two_ended(size_, width_)),
      kernels_(kernels_of(width_)) {
  const Index rows = columns_ + width_;
  band_.resize(to_size(rows * (width_ + 1)));
  right_side_.resize(to_size(rows));
  middle_.setZero(2 * width_ * (width_ + 1));
  middle_right_side_.setZero(2 * width_);
}

Inertia TwistedLdlt::factorize(const Vector& values) {
  for (std::size_t k = 0; k < band_.size(); ++k) band_[k] = TwoLanes::load(values.data() + 2 * k);
  if (padding_ > 0) band_[0] = {band_[0].lane(0), 1.0};
  Inertia inertia = kernels_.factorize(columns_, band_.data());
  if (!inertia.factorised) {
    const Index first = inertia.failed_at;
    const bool is_first = !is_pivot(band_[to_size(first * (width_ + 1))].lane(0));
    inertia.failed_at = is_first ? first : size_ - 1 - (first - padding_);
    return inertia;
  }
  const Inertia middle = factorize_middle();
  inertia.negative_pivots += middle.negative_pivots;
  inertia.factorised = middle.factorised;
  if (!middle.factorised) inertia.failed_at = columns_ + middle.failed_at;
  return inertia;
}

/// The middle's own entries are in the first lane; the second has its rows and columns reversed.
Inertia TwistedLdlt::factorize_middle() {
  const Index stride = width_ + 1;
  const TwoLanes* rest = band_.data() + columns_ * stride;
  middle_.setZero();
  for (Index column = 0; column < width_; ++column) {
    for (Index below = 0; column + below < width_; ++below) {
      const Index reversed = width_ - 1 - (column + below);
      middle_[column * stride + below] =
          rest[column * stride + below].lane(0) + rest[reversed * stride + below].lane(1);
    }
  }
  return kernels_.factorize_middle(middle_.data());
}

void TwistedLdlt::solve(Vector& b) {
  const auto reversed = [&](Index row) { return size_ - 1 - (row - padding_); };
  for (Index row = padding_; row < columns_; ++row) {
    right_side_[to_size(row)] = {b[row], b[reversed(row)]};
  }
  if (padding_ > 0) right_side_[0] = {b[0], 0.0};
  for (Index i = 0; i < width_; ++i) {
    right_side_[to_size(columns_ + i)] = {b[columns_ + i], 0.0};
  }
  kernels_.eliminate(columns_, band_.data(), right_side_.data());
  solve_middle();
  kernels_.substitute(columns_, band_.data(), right_side_.data());
  for (Index row = 0; row < columns_ + width_; ++row) b[row] = right_side_[to_size(row)].lane(0);
  for (Index row = padding_; row < columns_; ++row) {
    b[reversed(row)] = right_side_[to_size(row)].lane(1);
  }
}

void TwistedLdlt::solve_middle() {
  TwoLanes* rest = right_side_.data() + columns_;
  for (Index i = 0; i < width_; ++i) {
    middle_right_side_[i] = rest[i].lane(0) + rest[width_ - 1 - i].lane(1);
  }
  middle_right_side_.tail(width_).setZero();
  kernels_.solve_middle(middle_.data(), middle_right_side_.data());
  for (Index i = 0; i < width_; ++i) {
    rest[i] = {middle_right_side_[i], middle_right_side_[width_ - 1 - i]};
  }
}

}  // namespace der
