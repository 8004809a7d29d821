#include "der/solvers/banded_ldlt.hpp"

#include "der/core/loops.hpp"
#include "solvers/band_kernels.hpp"

namespace der {
namespace {

template <Index kWidth>
constexpr BandedLdlt::Kernels kKernels{factorize_band<kWidth, double>, eliminate<kWidth, double>,
                                       substitute<kWidth, double>};

// The usual widths are innermost loops.
template <Index kWidth>
Inertia factorize_chain(Index size, Index /*width*/, double* band, double* scratch) {
  return dispatch_simd([&] { return factorize_band<kWidth>(size, kWidth, band, scratch); });
}
template <Index kWidth>
void eliminate_chain(Index size, Index /*width*/, const double* band, double* b) {
  dispatch_simd([&] { eliminate<kWidth>(size, kWidth, band, b); });
}
template <Index kWidth>
void substitute_chain(Index size, Index /*width*/, const double* band, double* b) {
  dispatch_simd([&] { substitute<kWidth>(size, kWidth, band, b); });
}
template <Index kWidth>
constexpr BandedLdlt::Kernels kChainKernels{factorize_chain<kWidth>, eliminate_chain<kWidth>,
                                            substitute_chain<kWidth>};

BandedLdlt::Kernels kernels_of(Index half_bandwidth) {
  switch (half_bandwidth) {
    case 2:  // mass matrices of planar chains, solved with in every explicit step
      return kKernels<2>;
    case 5:  // chains in the plane
      return kChainKernels<5>;
    case 6:  // the same with joints
      return kChainKernels<6>;
    case 7:  // and legs of two edges between them
      return kChainKernels<7>;
    case 8:  // chains in space
      return kChainKernels<8>;
    case 10:  // the same with angles of sections
      return kChainKernels<10>;
    default:
      return kKernels<0>;
  }
}

}  // namespace

BandedLdlt::BandedLdlt(const Pattern& pattern)
    : size_(pattern.size),
      half_bandwidth_(pattern.half_bandwidth),
      layout_(MatrixLayout::band(pattern.size, pattern.half_bandwidth)),
      kernels_(kernels_of(pattern.half_bandwidth)) {
  band_.setZero(static_cast<Eigen::Index>(size_ + half_bandwidth_) * (half_bandwidth_ + 1));
  right_side_.setZero(size_ + half_bandwidth_);
  scratch_.setZero(half_bandwidth_);
}

Inertia BandedLdlt::factorize(const Vector& values) {
  const Index used = layout_.num_values();
  band_.head(used) = values.head(used);
  band_.tail(band_.size() - used).setZero();
  return kernels_.factorize(size_, half_bandwidth_, band_.data(), scratch_.data());
}

void BandedLdlt::solve(Vector& b) {
  right_side_.head(size_) = b;
  right_side_.tail(half_bandwidth_).setZero();
  kernels_.eliminate(size_, half_bandwidth_, band_.data(), right_side_.data());
  kernels_.substitute(size_, half_bandwidth_, band_.data(), right_side_.data());
  b = right_side_.head(size_);
}

}  // namespace der
