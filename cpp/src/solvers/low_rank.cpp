#include "der/solvers/low_rank.hpp"

#include "der/core/index.hpp"

namespace der {

LowRankSolver::LowRankSolver(LinearSolver& solver, Index size)
    : solver_(solver), column_(Vector::Zero(size)) {}

void LowRankSolver::reduce(const LowRank& change, const Eigen::Ref<const Vector>& x,
                           Eigen::Ref<Vector> out) const {
  for (Index j = 0; j < change.rank(); ++j) {
    out[j] = 0.0;
    for (const auto& [row, value] : change.columns[to_size(j)]) out[j] += value * x[row];
  }
}

void LowRankSolver::factorize(const LowRank& change) {
  const Index rank = change.rank();
  change_ = &change;
  answers_.resize(column_.size(), rank);
  compliance_.resize(rank, rank);
  reduced_.resize(rank);
  forces_.resize(rank);
  for (Index j = 0; j < rank; ++j) {
    column_.setZero();
    for (const auto& [row, value] : change.columns[to_size(j)]) column_[row] += value;
    solver_.solve(column_);
    answers_.col(j) = column_;
    reduce(change, column_, compliance_.col(j));
  }
  coupling_.setIdentity(rank, rank);
  coupling_.noalias() += change.core * compliance_;
  factors_.compute(coupling_);
}

void LowRankSolver::solve(Vector& b) {
  solver_.solve(b);
  reduce(*change_, b, reduced_);
  forces_.noalias() = change_->core * reduced_;
  reduced_.noalias() = factors_.solve(forces_);
  b.noalias() -= answers_ * reduced_;
}

}  // namespace der
