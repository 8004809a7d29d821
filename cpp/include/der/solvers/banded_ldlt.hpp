#pragma once

#include <string_view>

#include "der/core/types.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

/// L D L^T of a symmetric band matrix without pivoting (Golub and Van Loan, Matrix Computations,
/// 4th ed., section 4.3.6), in O(size * half_bandwidth^2), from the first row on. For the
/// half-bandwidths of chains the kernels know them at compile time.
class BandedLdlt final : public LinearSolver {
 public:
  explicit BandedLdlt(const Pattern& pattern);
  [[nodiscard]] std::string_view name() const override { return "banded"; }
  [[nodiscard]] const MatrixLayout& layout() const override { return layout_; }
  Inertia factorize(const Vector& values) override;
  void solve(Vector& b) override;

  /// Those of solvers/band_kernels.hpp for one half-bandwidth.
  struct Kernels {
    Inertia (*factorize)(Index size, Index half_bandwidth, double* band, double* scratch);
    void (*eliminate)(Index size, Index half_bandwidth, const double* band, double* b);
    void (*substitute)(Index size, Index half_bandwidth, const double* band, double* b);
  };

 private:
  Index size_ = 0;
  Index half_bandwidth_ = 0;
  MatrixLayout layout_;
  Kernels kernels_;
  // Both are longer by half_bandwidth columns of zeros, which spares the kernels a test for the
  // end.
  Vector band_;  ///< column j: 1 / d_j, then the multipliers l_{j+1,j} ..
  Vector right_side_;
  Vector scratch_;  ///< of one column
};

}  // namespace der
