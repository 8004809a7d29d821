// A matrix S + B N B' against dense algebra.
#include "der/solvers/low_rank.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <random>

#include "der/catalog/linear_solvers.hpp"
#include "der/core/index.hpp"

namespace der::test {
namespace {

constexpr Index kSize = 30;

Pattern tridiagonal() {
  Pattern pattern;
  pattern.size = kSize;
  pattern.half_bandwidth = 1;
  pattern.outer.push_back(0);
  for (Index j = 0; j < kSize; ++j) {
    pattern.inner.push_back(j);
    if (j + 1 < kSize) pattern.inner.push_back(j + 1);
    pattern.outer.push_back(pattern.nonzeros());
  }
  return pattern;
}

Eigen::MatrixXd dense(const LowRank& change) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(kSize, change.rank());
  for (Index j = 0; j < change.rank(); ++j) {
    for (const auto& [row, value] : change.columns[to_size(j)]) columns(row, j) += value;
  }
  return columns * change.core * columns.transpose();
}

}  // namespace

TEST_CASE("low rank: a symmetric solver solves with an unsymmetric matrix, N singular or not") {
  const Pattern pattern = tridiagonal();
  Eigen::MatrixXd symmetric = Eigen::MatrixXd::Zero(kSize, kSize);
  for (Index j = 0; j < kSize; ++j) {
    symmetric(j, j) = j % 5 == 2 ? -4.0 : 4.0;
    if (j + 1 < kSize) symmetric(j + 1, j) = symmetric(j, j + 1) = 1.0;
  }
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const auto& solver_name : linear_solver_names()) {
    if (solver_name == "cholmod") continue;
    const LinearSolverChoice choice = make_linear_solver(solver_name, pattern);
    Vector values = Vector::Zero(choice.solver->layout().num_values() + 1);
    for (Index j = 0; j < kSize; ++j) {
      for (Index i = j; i < std::min(kSize, j + 2); ++i) {
        values[choice.solver->layout().slot(i, j)] = symmetric(i, j);
      }
    }
    CHECK(choice.solver->factorize(values).factorised);
    LowRankSolver corrected(*choice.solver, kSize);
    for (const Index rank : {1, 4, 7}) {
      LowRank change;
      for (Index j = 0; j < rank; ++j) {
        // The last column is empty, as that of a held coordinate.
        auto& column = change.columns.emplace_back();
        if (j + 1 == rank && rank > 1) continue;
        column = {{3 * j, uniform(random)}, {3 * j + 4, uniform(random)}};
      }
      change.core.setZero(rank, rank);
      for (Index i = 0; i < rank; ++i) {
        for (Index j = 0; j < rank; ++j) {
          if (i != 1) change.core(i, j) = 3.0 * uniform(random);
        }
      }
      corrected.factorize(change);
      const Vector b = Vector::Random(kSize);
      Vector x = b;
      corrected.solve(x);
      CHECK(((symmetric + dense(change)) * x - b).norm() < 1e-12 * b.norm());
    }
  }
}

}  // namespace der::test
