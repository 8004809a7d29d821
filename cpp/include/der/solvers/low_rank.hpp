#pragma once

#include <Eigen/LU>
#include <vector>

#include "der/core/types.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

/// A matrix B N B' of low rank, over the free degrees of freedom. B is sparse and stays as it is, N
/// is small, dense and changes with the shape; it need not be symmetric.
struct LowRank {
  struct Entry {
    Index row = 0;  ///< number of the free degree of freedom
    double value = 0.0;
  };

  std::vector<std::vector<Entry>> columns;  ///< of B
  Eigen::MatrixXd core;                     ///< N, as large as B has columns

  [[nodiscard]] bool empty() const { return columns.empty(); }
  [[nodiscard]] Index rank() const { return static_cast<Index>(columns.size()); }
};

/// Solves (S + B N B') x = b with a symmetric solver that has factorised S (Woodbury's formula,
/// Golub and Van Loan, Matrix Computations, 4th ed., section 2.1.4):
///   x = S^-1 b - Z (I + N B'Z)^-1 N B' S^-1 b,   Z = S^-1 B.
/// S has to be regular, N need not be. Memory is allocated where the rank changes, and kept.
class LowRankSolver {
 public:
  LowRankSolver(LinearSolver& solver, Index size);

  /// To be called once the solver has factorised S; takes one solve a column of B.
  void factorize(const LowRank& change);
  /// Solves in place, with the last change, which has to exist still.
  void solve(Vector& b);

 private:
  /// B' x.
  void reduce(const LowRank& change, const Eigen::Ref<const Vector>& x,
              Eigen::Ref<Vector> out) const;

  LinearSolver& solver_;
  const LowRank* change_ = nullptr;
  Vector column_;               // over the free degrees of freedom
  Eigen::MatrixXd answers_;     // Z
  Eigen::MatrixXd compliance_;  // B'Z
  Eigen::MatrixXd coupling_;    // I + N B'Z
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
  Vector reduced_;
  Vector forces_;
};

}  // namespace der
