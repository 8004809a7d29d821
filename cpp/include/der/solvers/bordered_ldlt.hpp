#pragma once

#include <string_view>
#include <vector>

#include "der/core/types.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

/// L D L^T of a symmetric band matrix with borders, those of rings, without pivoting: as
/// BandedLdlt, but each column of a ring has the rows of its border, too, with which the ring ends.
/// Elimination fills nothing else, so that its time stays linear in the size, and the pivots have
/// the signs of the eigenvalues as ever.
class BorderedLdlt final : public LinearSolver {
 public:
  explicit BorderedLdlt(const Pattern& pattern);
  [[nodiscard]] std::string_view name() const override { return "banded"; }
  [[nodiscard]] const MatrixLayout& layout() const override { return layout_; }
  Inertia factorize(const Vector& values) override;
  void solve(Vector& b) override;

  /// Consecutive columns with the same border.
  struct Columns {
    Index first = 0;
    Index end = 0;
    Index border_row = 0;    ///< first row of their border
    Index border_rows = 0;   ///< 0: none
    Index border_start = 0;  ///< where the border of the first column is stored
  };
  /// The loops over such columns, for one half-bandwidth and one number of rows.
  struct Kernels {
    /// Eliminates the columns; `corner` collects what that does to the border's own entries.
    Inertia (*factorize)(const Columns& columns, Index width, Index stride, double* band,
                         double* border, double* corner, double* scratch);
    void (*forward)(const Columns& columns, Index width, Index stride, const double* band,
                    const double* border, double* b);
    void (*backward)(const Columns& columns, Index width, Index stride, const double* band,
                     const double* border, double* b);
  };

 private:
  struct Part {
    Columns columns;
    Index stride = 0;  ///< stored values of a column's border
    Kernels kernels{};
  };
  void add_part(const Columns& columns, Index stride);

  Index size_ = 0;
  Index half_bandwidth_ = 0;
  MatrixLayout layout_;
  std::vector<Part> parts_;  ///< all columns, in their order
  // As those of BandedLdlt; the border likewise goes on for half_bandwidth columns of zeros.
  Vector band_;
  Vector border_;  ///< of each column of a ring: its rows of the border, then their multipliers
  Vector corner_;
  Vector scratch_;
  Vector right_side_;
};

}  // namespace der
