#pragma once

#include <string_view>

#include "der/core/types.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

/// L D L^T of a symmetric band matrix without pivoting (Golub and Van Loan, Matrix Computations,
/// 4th ed., section 4.3.6), in O(size * half_bandwidth^2). Chains have a half-bandwidth of 5 in the
/// plane; for the usual widths the kernels know it at compile time.
class BandedLdlt final : public LinearSolver {
 public:
  explicit BandedLdlt(const Pattern& pattern);
  [[nodiscard]] std::string_view name() const override { return "banded"; }
  [[nodiscard]] const MatrixLayout& layout() const override { return layout_; }
  Inertia factorize(const Vector& values) override;
  void solve(Vector& b) override;

 private:
  using FactorizeKernel = Inertia (*)(Index size, Index half_bandwidth, double* band,
                                      double* scratch);
  using SolveKernel = void (*)(Index size, Index half_bandwidth, const double* band, double* b);

  Index size_ = 0;
  Index half_bandwidth_ = 0;
  MatrixLayout layout_;
  FactorizeKernel factorize_kernel_ = nullptr;
  SolveKernel solve_kernel_ = nullptr;
  // Both are longer by half_bandwidth columns of zeros, which spares the kernels a test for the
  // end.
  Vector band_;  ///< column j: 1 / d_j, then the multipliers l_{j+1,j} ..
  Vector right_side_;
  Vector scratch_;  ///< of one column
};

}  // namespace der
