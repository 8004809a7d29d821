#include <Eigen/SparseCholesky>

#include "der/solvers/sparse_ldlt.hpp"
#include "solvers/compressed_matrix.hpp"

namespace der {
namespace {

class SimplicialLdlt final : public LinearSolver {
 public:
  explicit SimplicialLdlt(const Pattern& pattern)
      : layout_(MatrixLayout::compressed(pattern)), matrix_(compressed_matrix(pattern)) {
    ldlt_.analyzePattern(matrix_);
  }
  [[nodiscard]] std::string_view name() const override { return "simplicial_ldlt"; }
  [[nodiscard]] const MatrixLayout& layout() const override { return layout_; }

  Inertia factorize(const Vector& values) override {
    std::copy_n(values.data(), layout_.num_values(), matrix_.valuePtr());
    ldlt_.factorize(matrix_);
    Inertia inertia;
    inertia.factorised = ldlt_.info() == Eigen::Success && ldlt_.vectorD().allFinite();
    if (inertia.factorised) {
      inertia.negative_pivots = static_cast<Index>((ldlt_.vectorD().array() < 0.0).count());
    }
    return inertia;
  }

  void solve(Vector& b) override { b = ldlt_.solve(b); }

 private:
  MatrixLayout layout_;
  Eigen::SparseMatrix<double, Eigen::ColMajor, Index> matrix_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double, Eigen::ColMajor, Index>, Eigen::Lower> ldlt_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_simplicial_ldlt(const Pattern& pattern) {
  return std::make_unique<SimplicialLdlt>(pattern);
}

}  // namespace der
