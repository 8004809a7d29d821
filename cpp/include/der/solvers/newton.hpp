#pragma once

#include <string>

#include "der/core/cancel_callback.hpp"
#include "der/core/types.hpp"
#include "der/model/dof_map.hpp"
#include "der/solvers/linear_solver.hpp"
#include "der/solvers/low_rank.hpp"
#include "der/solvers/newton_problem.hpp"

namespace der {

struct NewtonOptions {
  double residual_tolerance = 1e-9;  ///< against the largest acting force
  double step_tolerance = 1e-9;      ///< against the model's size
  int max_iterations = 50;
};

struct NewtonReport {
  bool converged = false;
  int iterations = 0;
  double residual = 0.0;      ///< largest component over the free degrees of freedom [N]
  double force_scale = 0.0;   ///< largest acting force [N]
  Index worst_dof = -1;       ///< if not converged: full number of that with the largest residual
  Index negative_pivots = 0;  ///< of the last matrix, before any shift
  std::string failure;        ///< in words, if not converged
};

/// Newton's method for a NewtonProblem, on preallocated memory: an iteration allocates nothing.
///
/// First plain Newton steps, which converge fastest though the residual may rise on the way (a rod
/// that turns is first stretched by its step, then springs back), with the matrix that the problem
/// corrects after them. If they do not get there, again from the guess with a line search on the
/// slope of the potential along the step. Where the matrix is not positive definite it is shifted
/// until it is, so that every step leads downhill. The signs of a matrix tell nothing where the
/// derivative has another, unsymmetric part: full steps then take it as it is.
class Newton {
 public:
  /// `num_values`: length of the array of values that the problem fills. `beat` is called once an
  /// iteration.
  Newton(const DofMap& dofs, LinearSolver& solver, Index num_values, const NewtonOptions& options,
         CancelCallback beat = {});

  /// Solves from the problem's guess, at which its solution is again if not converged.
  NewtonReport solve(NewtonProblem& problem);
  /// Solves likewise with the line search only: slower, but it does not jump to the basin of
  /// another minimum.
  NewtonReport solve_downhill(NewtonProblem& problem);
  /// Solves by plain steps alone, with the matrix as it is where it is not positive definite: they
  /// lead to a solution near the guess, a minimum of the potential or not.
  NewtonReport solve_nearby(NewtonProblem& problem);

  /// The displacement at the last iterate [m], known to its own rounding.
  [[nodiscard]] const Vector& displacement() const { return displacement_; }
  /// Left side of the equations at the last iterate, over all degrees of freedom [N]; on held ones
  /// it is the force that the support has to provide.
  [[nodiscard]] const Vector& residual() const { return residual_; }

 private:
  enum class Mode { FullSteps, LineSearch, Nearby };

  NewtonReport iterate(NewtonProblem& problem, Mode mode);
  bool find_direction(NewtonProblem& problem, Mode mode, NewtonReport& report);
  void predict_mixed_point(NewtonProblem& problem, NewtonReport& report);
  bool factorize(bool positive, NewtonReport& report);
  double line_search(NewtonProblem& problem);
  void move(NewtonProblem& problem, const Vector& start, double factor);
  [[nodiscard]] double slope() const { return residual_.dot(step_); }
  void measure(const NewtonProblem& problem, NewtonReport& report) const;
  [[nodiscard]] Index worst_dof() const;

  const DofMap& dofs_;
  LinearSolver& solver_;
  LowRankSolver corrected_;  // of the matrix with the problem's low-rank part
  NewtonOptions options_;
  CancelCallback beat_;
  Vector residual_;      // all degrees of freedom
  Vector values_;        // of the matrix, shifted where need be
  Vector direction_;     // over the free degrees of freedom
  Vector step_;          // as far along it as the problem admits, over all, zero on held ones
  double taken_ = 1.0;   // share of the step that is taken
  double length_ = 0.0;  // largest motion in it [m]
  double change_ = 0.0;  // its nonlinearity (StepBound::change)
  Vector displacement_;
  Vector line_start_;  // displacement that the line search starts from
  double last_shift_ = 0.0;
};

}  // namespace der
