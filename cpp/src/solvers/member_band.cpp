#include "der/solvers/member_band.hpp"

#include <algorithm>

#include "solvers/band_kernels.hpp"

namespace der {
namespace {

/// Notes in which lanes all pivots are positive numbers.
template <class T>
class PositivePivots {
 public:
  bool take(Index /*column*/, const T& pivot) {
    positive_ *= T::is_positive(pivot);
    return true;
  }
  [[nodiscard]] T positive() const { return positive_; }

 private:
  T positive_ = 1.0;
};

template <class T, Index kWidth>
T factorize_members(Index columns, T* band) {
  return run_member_loop<T>([&] {
    PositivePivots<T> pivots;
    factorize_band<kWidth, 1>(columns, band, pivots, NoRightSide{});
    return pivots.positive();
  });
}
template <class T, Index kWidth, Index kMatrices>
T factorize_and_eliminate_members(Index columns, T* band, T* b) {
  return run_member_loop<T>([&] {
    PositivePivots<T> pivots;
    factorize_band<kWidth, kMatrices>(columns, band, pivots, b);
    return pivots.positive();
  });
}
template <class T, Index kWidth>
void eliminate_members(Index columns, const T* band, T* b) {
  run_member_loop<T>([&] { eliminate<kWidth>(columns, kWidth, band, b); });
}
template <class T, Index kWidth, class Number>
void substitute_members(Index columns, const Number* band, Number* b) {
  run_member_loop<T>([&] { substitute<kWidth>(columns, kWidth, band, b); });
}

}  // namespace

template <class T>
template <Index kWidth>
typename MemberBand<T>::Kernels MemberBand<T>::kernels() {
  using Pair = LanePair<T>;
  return {factorize_members<T, kWidth>,
          eliminate_members<T, kWidth>,
          substitute_members<T, kWidth, T>,
          factorize_and_eliminate_members<T, kWidth, 1>,
          factorize_and_eliminate_members<T, kWidth, 2>,
          substitute_members<T, kWidth, Pair>};
}

template <class T>
typename MemberBand<T>::Kernels MemberBand<T>::kernels_of(Index half_bandwidth) {
  switch (half_bandwidth) {
    case 2:  // mass matrices of planar chains
      return kernels<2>();
    case 3:  // their stiffness, where they have two free nodes; masses in space
      return kernels<3>();
    case 4:  // masses in space, with angles of sections
      return kernels<4>();
    case 5:  // chains in the plane
      return kernels<5>();
    case 8:  // chains in space
      return kernels<8>();
    case 10:  // the same with angles of sections
      return kernels<10>();
    default:
      return {};
  }
}

template <class T>
bool MemberBand<T>::suits(const Pattern& pattern) {
  return pattern.borders.empty() && kernels_of(pattern.half_bandwidth).factorize != nullptr;
}

template <class T>
MemberBand<T>::MemberBand(const Pattern& pattern, Elimination order)
    : size_(pattern.size),
      width_(pattern.half_bandwidth),
      order_(order),
      kernels_(kernels_of(width_)) {
  if (order == Elimination::FromStart) {
    band_.resize((size_ + width_) * (width_ + 1));
    right_side_.resize(size_ + width_);
    return;
  }
  columns_ = (size_ - width_ + 1) / 2;
  padding_ = (size_ - width_) % 2;
  const Index rows = columns_ + width_;
  band_.resize(2 * rows * (width_ + 1) + 1);
  right_side_.resize(2 * rows);
  middle_.resize(2 * width_ * (width_ + 1));
  middle_right_side_.resize(2 * width_);
}

template <class T>
T MemberBand<T>::factorize() {
  clear_columns_behind();
  return kernels_.factorize(size_, band_.data());
}

template <class T>
void MemberBand<T>::solve(MemberVector<T>& b) {
  take_right_side(b);
  kernels_.eliminate(size_, band_.data(), right_side_.data());
  substitute(b);
}

template <class T>
T MemberBand<T>::factorize_and_solve(MemberVector<T>& b) {
  if (order_ == Elimination::FromBothEnds) return factorize_and_solve_from_both_ends(b);
  clear_columns_behind();
  take_right_side(b);
  const T positive = kernels_.factorize_and_eliminate(size_, band_.data(), right_side_.data());
  substitute(b);
  return positive;
}

template <class T>
void MemberBand<T>::clear_columns_behind() {
  run_member_loop<T>([&] {
    const Index used = size_ * (width_ + 1);
    std::fill(band_.data() + used, band_.data() + band_.size(), T(0.0));
  });
}

template <class T>
void MemberBand<T>::take_right_side(const MemberVector<T>& b) {
  run_member_loop<T>([&] {
    std::copy_n(b.data(), size_, right_side_.data());
    std::fill_n(right_side_.data() + size_, width_, T(0.0));
  });
}

template <class T>
void MemberBand<T>::substitute(MemberVector<T>& b) {
  kernels_.substitute(size_, band_.data(), right_side_.data());
  run_member_loop<T>([&] { std::copy_n(right_side_.data(), size_, b.data()); });
}

/// The middle's own entries are in the first half; the second has its rows and columns reversed.
template <class T>
T MemberBand<T>::factorize_and_solve_from_both_ends(MemberVector<T>& b) {
  const auto reversed = [&](Index row) { return size_ - 1 - (row - padding_); };
  LanePair<T>* const right_side = pairs(right_side_);
  LanePair<T>* const rest_right = right_side + columns_;
  if (padding_ > 0) band_[1] = T(1.0);
  run_member_loop<T>([&] {
    for (Index row = padding_; row < columns_; ++row) right_side[row] = {b[row], b[reversed(row)]};
    if (padding_ > 0) right_side[0] = {b[0], T(0.0)};
    for (Index i = 0; i < width_; ++i) rest_right[i] = {b[columns_ + i], T(0.0)};
  });
  const T halves =
      kernels_.factorize_and_eliminate_pairs(columns_, band_.data(), right_side_.data());
  run_member_loop<T>([&] {
    const Index stride = width_ + 1;
    const LanePair<T>* rest = pairs(band_) + columns_ * stride;
    std::fill_n(middle_.data(), middle_.size(), T(0.0));
    for (Index column = 0; column < width_; ++column) {
      for (Index below = 0; column + below < width_; ++below) {
        const Index opposite = width_ - 1 - (column + below);
        middle_[column * stride + below] =
            rest[column * stride + below].first + rest[opposite * stride + below].second;
      }
    }
    for (Index i = 0; i < width_; ++i) {
      middle_right_side_[i] = rest_right[i].first + rest_right[width_ - 1 - i].second;
      middle_right_side_[width_ + i] = T(0.0);
    }
  });
  const T middle =
      kernels_.factorize_and_eliminate(width_, middle_.data(), middle_right_side_.data());
  kernels_.substitute(width_, middle_.data(), middle_right_side_.data());
  run_member_loop<T>([&] {
    for (Index i = 0; i < width_; ++i) {
      rest_right[i] = {middle_right_side_[i], middle_right_side_[width_ - 1 - i]};
    }
  });
  kernels_.substitute_pairs(columns_, pairs(band_), right_side);
  run_member_loop<T>([&] {
    for (Index row = 0; row < columns_ + width_; ++row) b[row] = right_side[row].first;
    for (Index row = padding_; row < columns_; ++row) b[reversed(row)] = right_side[row].second;
  });
  return halves * middle;
}

#define DER_INSTANTIATE(T) template class MemberBand<T>;
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
