#pragma once

#include <memory>

#include "der/assembly/pattern.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

/// Solves (M + t C) x = b, M the mass matrix, C the model's diagonal damping, over the free degrees
/// of freedom: a division where no masses are coupled. Factorises again when `t` changes.
class MassSolver {
 public:
  explicit MassSolver(const Model& model);
  /// `b` has one entry a degree of freedom and becomes the solution, 0 on held ones. `t` [s].
  void solve(double t, Vector& b);

 private:
  void prepare(double t);

  const Model& model_;
  std::unique_ptr<Pattern> pattern_;      // null where the mass is diagonal
  std::unique_ptr<LinearSolver> solver_;  // likewise
  Vector values_;
  Vector diagonal_;             // lumped + t C
  Vector free_;                 // over the free degrees of freedom
  double prepared_for_ = -1.0;  // t [s]; -1: none yet
};

}  // namespace der
