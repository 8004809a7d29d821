#pragma once

#include "der/core/types.hpp"
#include "der/solvers/low_rank.hpp"

namespace der {

/// How much of a step may be taken.
struct StepBound {
  double share = 1.0;  ///< largest admissible share of the step, in (0, 1]
  double change =
      0.0;  ///< nonlinearity of that share of it: largest change of an edge over its length
};

/// A system of nonlinear equations as Newton's method sees it: a residual [N] and its derivative as
/// functions of a displacement [m] of all degrees of freedom, held ones included. The residual is
/// the gradient of a potential, or nearly so, unless there is a `low_rank` part.
class NewtonProblem {
 public:
  NewtonProblem() = default;
  NewtonProblem(const NewtonProblem&) = delete;
  NewtonProblem& operator=(const NewtonProblem&) = delete;
  virtual ~NewtonProblem() = default;

  /// Sets `displacement` to that of the guess, which is remembered.
  virtual void begin(Vector& displacement) = 0;
  /// As `begin`, back from wherever the solution is now to the guess remembered.
  virtual void begin_again(Vector& displacement) = 0;
  /// The solution is at another displacement now, in its free components. The problem
  /// prepares here whatever the equations need at a new point.
  virtual void solution_changed(const Vector& displacement) = 0;

  /// Sets the left side of the equations at the solution, over all degrees of freedom.
  virtual void residual(Vector& residual) = 0;
  /// Sets `residual` likewise, and `values` to its derivative in the layout of the linear solver.
  virtual void system(Vector& residual, Vector& values) = 0;
  /// The part of the derivative of the last `system` that is not in `values`: the unsymmetric one
  /// of a residual without a potential. Null: there is none.
  [[nodiscard]] virtual const LowRank* low_rank() const { return nullptr; }
  /// May improve the derivative just evaluated after a `step` (all degrees of freedom), of which
  /// the share `taken` led here.
  virtual void mixed_point_update(const Vector& step, double taken, Vector& values) = 0;
  /// Takes out of the derivative just evaluated what `mixed_point_update` would replace.
  virtual void remove_mixed_point_part(Vector& values) = 0;

  /// The largest admissible share of a step (all degrees of freedom, 0 on held ones).
  virtual StepBound largest_step(const Vector& step) = 0;

  /// Largest force [N] that acted in the last evaluation: what residuals are compared with.
  [[nodiscard]] virtual double acting_force() const = 0;
  /// Rounding error [m] of the solution's positions.
  [[nodiscard]] virtual double position_rounding() const = 0;
  /// Rounding error [N] of the residual. Uses `values`, which the next `system` sets anew.
  virtual double residual_rounding(Vector& values) = 0;
};

}  // namespace der
