#include "der/core/error.hpp"
#include "der/solvers/sparse_ldlt.hpp"

#ifdef DER_HAS_CHOLMOD
#include <Eigen/CholmodSupport>
#include <cmath>

#include "solvers/compressed_matrix.hpp"
#endif

namespace der {

#ifdef DER_HAS_CHOLMOD
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

/// Opens the pivots of Eigen's wrapper, which keeps them to itself.
class LdltWithPivots : public Eigen::CholmodSimplicialLDLT<Matrix, Eigen::Lower> {
 public:
  [[nodiscard]] Inertia inertia() const {
    Inertia result;
    const auto* starts = static_cast<const int*>(m_cholmodFactor->p);
    const auto* entries = static_cast<const double*>(m_cholmodFactor->x);
    for (Index j = 0; j < cols(); ++j) {
      const double pivot = entries[starts[j]];
      if (!(std::abs(pivot) > 0.0) || !std::isfinite(pivot)) return Inertia{};
      result.negative_pivots += pivot < 0.0 ? 1 : 0;
    }
    result.factorised = true;
    return result;
  }
};

class Cholmod final : public LinearSolver {
 public:
  explicit Cholmod(const Pattern& pattern)
      : layout_(MatrixLayout::compressed(pattern)), matrix_(compressed_matrix(pattern)) {
    ldlt_.cholmod().print = 0;  // CHOLMOD would write its warnings to the terminal
    ldlt_.analyzePattern(matrix_);
  }
  [[nodiscard]] std::string_view name() const override { return "cholmod"; }
  [[nodiscard]] const MatrixLayout& layout() const override { return layout_; }

  Inertia factorize(const Vector& values) override {
    std::copy_n(values.data(), layout_.num_values(), matrix_.valuePtr());
    ldlt_.factorize(matrix_);
    return ldlt_.info() == Eigen::Success ? ldlt_.inertia() : Inertia{};
  }

  void solve(Vector& b) override { b = ldlt_.solve(b); }

 private:
  MatrixLayout layout_;
  Matrix matrix_;
  LdltWithPivots ldlt_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_cholmod(const Pattern& pattern) {
  return std::make_unique<Cholmod>(pattern);
}

#else

std::unique_ptr<LinearSolver> make_cholmod(const Pattern& /*pattern*/) {
  throw Error("not_available",
              "linear solver 'cholmod' is not in this build (CHOLMOD was not found when der was "
              "built); use 'banded' or 'simplicial_ldlt'");
}

#endif

}  // namespace der
