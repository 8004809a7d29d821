#pragma once

#include <string_view>
#include <vector>

#include "der/core/lanes.hpp"
#include "der/core/types.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

/// L D L^T of the narrow band matrix of a chain, from both ends to the middle: the two halves are
/// independent of one another, so that they run side by side in two lanes, and a block of the
/// band's width joins them (a twisted factorisation; Golub and Van Loan, Matrix Computations,
/// 4th ed., section 4.3.6, is the band's). MatrixLayout::two_ended says where entries lie.
class TwistedLdlt final : public LinearSolver {
 public:
  /// Whether there are kernels for the matrix: half-bandwidth 5, 8 or 10, and halves worth it.
  static bool suits(const Pattern& pattern);

  /// The loops of one half-bandwidth.
  struct Kernels {
    Inertia (*factorize)(Index columns, TwoLanes* band);
    void (*eliminate)(Index columns, const TwoLanes* band, TwoLanes* b);
    void (*substitute)(Index columns, const TwoLanes* band, TwoLanes* b);
    Inertia (*factorize_middle)(double* band);
    void (*solve_middle)(const double* band, double* b);
  };

  explicit TwistedLdlt(const Pattern& pattern);
  [[nodiscard]] std::string_view name() const override { return "banded"; }
  [[nodiscard]] const MatrixLayout& layout() const override { return layout_; }
  Inertia factorize(const Vector& values) override;
  void solve(Vector& b) override;

 private:
  static Kernels kernels_of(Index half_bandwidth);

  Inertia factorize_middle();
  void solve_middle();

  Index size_ = 0;
  Index width_ = 0;
  Index columns_ = 0;  ///< that each lane eliminates
  Index padding_ = 0;  ///< 1: the second lane begins with a column of its own, of no effect
  MatrixLayout layout_;
  Kernels kernels_;
  std::vector<TwoLanes> band_;  ///< the columns of both halves, then those of the middle
  std::vector<TwoLanes> right_side_;
  // The middle, and zeros behind it that spare the kernels a test for the end.
  Vector middle_;
  Vector middle_right_side_;
};

}  // namespace der
