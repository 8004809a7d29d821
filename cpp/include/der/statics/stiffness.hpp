#pragma once

#include "der/assembly/assembler.hpp"
#include "der/core/cancel_callback.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

/// Stability of an equilibrium, from the curvature of the potential.
struct Stability {
  Index unstable_directions = 0;  ///< independent directions in which it falls
  /// Directions in which it is flat to rounding: rigid motions that nothing holds, or a critical
  /// load.
  Index neutral_directions = 0;
  /// Directions in which rounding hides the sign of the curvature: the mesh is too fine.
  Index unknown_directions = 0;
  /// Directions that the assembled stiffness leaves in doubt, so that they were judged element by
  /// element.
  Index doubtful_directions = 0;
  /// Whether there is a verdict: not where circulatory loads act, which have no potential.
  bool judged = true;
  [[nodiscard]] const char* name() const {
    if (!judged) return "not_judged";
    if (unstable_directions > 0) return "unstable";
    if (unknown_directions > 0) return "unknown";
    return neutral_directions > 0 ? "neutral" : "stable";
  }
};

/// A direction and the curvature of the potential along it.
struct SoftDirection {
  Vector direction;        ///< over the free degrees of freedom, of length 1
  double curvature = 0.0;  ///< [N/m]
};

/// The stiffness K at one shape: the Hessian of the potential over the free degrees of freedom, in
/// the sparse layout of the linear solver, which it borrows for its factorisations.
class Stiffness {
 public:
  /// `beat` is called at each evaluation, factorisation and solution.
  Stiffness(const Model& model, const Assembler& assembler, LinearSolver& solver,
            CancelCallback beat = {});

  void evaluate(const Configuration& here);
  /// Gradient [N] of the elements' energies at the same shape, all degrees of freedom.
  [[nodiscard]] const Vector& gradient() const { return gradient_; }
  /// K in the layout of the linear solver.
  [[nodiscard]] const Vector& values() const { return values_; }
  [[nodiscard]] Vector& values() { return values_; }

  /// Factorises K + shift U, with the unit matrix U but for angles, which count times the length of
  /// the model, or K + shift M. A pivot that vanishes moves the shift a little.
  Inertia factorize(double shift = 0.0) { return factorize(shift, units_); }
  Inertia factorize(double shift, const Mass& mass);
  /// Solves with the last factorisation, in place; over the free degrees of freedom.
  void solve(Vector& right_side) {
    beat();
    solver_.solve(right_side);
  }

  /// Solves K x = b in place where the rounding of the assembled matrix is not small against the
  /// softest eigenvalues: conjugate gradients on K taken element by element, the matrix being the
  /// preconditioner. Returns false, `b` being of no use, if K is not positive definite or no
  /// solution is reached.
  bool solve_by_elements(Vector& b);

  /// Eigenvalues [N/m] smaller than this cannot be distinguished from zero in the assembled matrix.
  [[nodiscard]] double rounding() const;
  /// The same for the eigenvalues of K and a mass matrix that is nowhere below the diagonal `mass`
  /// (all degrees of freedom) [1/s^2]. Angles have rounding errors of their own.
  [[nodiscard]] double rounding_over(const Vector& mass) const;
  /// Counts eigenvalues by the signs of the pivots of two factorisations, shifted by the rounding
  /// error to either side. Those between are judged by second variations, which keep their digits:
  /// each element's terms are taken of differences.
  Stability stability();
  /// Whether rounding leaves the eigenvalues alone: none is nearer to zero than 1e3 times
  /// `rounding()`. At shapes near this one the pivots then find the place where one passes zero to
  /// 1e-4 of its size at worst, and in practice to 1e-6.
  bool is_clear();
  /// The stability by the signs of the pivots alone, for shapes near one that is clear.
  Stability stability_by_pivots();
  /// The softest directions, one a column over the free degrees of freedom: those in which
  /// `stability()` found the potential flat, where it found so many and no unstable ones.
  Eigen::MatrixXd softest_directions(Index count);
  /// Adds to K a spring at one degree of freedom for each column of `neutral`, a basis of
  /// directions d with K d = 0. They are stiff then, and for any symmetric A with A d = 0 nothing
  /// else changes in K + a A: its other directions with no curvature are those that the springs do
  /// not see.
  void hold(const Eigen::MatrixXd& neutral);
  /// The eigenvector of the smallest eigenvalue, to a few digits: by inverse iteration with a shift
  /// just beyond it, found from the inertia, or, if it is too small for the matrix, by second
  /// variations. Its sign makes the largest component positive.
  SoftDirection softest();
  /// The eigenvector of the eigenvalue nearest to zero, likewise.
  SoftDirection nearest_to_zero();

 private:
  /// Some directions, in the order of their curvatures.
  struct SoftSpace {
    Eigen::MatrixXd directions;  // of length 1, over the free degrees of freedom, one a column
    Vector curvatures;           // [N/m]
    Vector rounding;             // of the curvatures [N/m]
    Vector errors;               // by which the iteration may have missed the eigenvalues [N/m]
  };

  void beat() const {
    if (beat_) beat_();
  }
  /// Factorises K plus the smallest shift that makes it positive definite but for so many
  /// directions, to about a third, and returns the shift; at least the rounding error.
  double factorize_positive(Index but = 0);
  void judge_doubtful(Stability& stability);
  /// The softest directions; where `below` of them are clearly unstable, those nearest to zero
  /// instead, by their sizes: the far ones would hide them from the iteration.
  SoftSpace softest_space(Index count, Index below = 0);
  /// The softest directions in the span of `basis`, or those nearest to zero.
  SoftSpace rayleigh_ritz(const Eigen::MatrixXd& basis, Index count, bool nearest) const;
  SoftDirection inverse_iteration();
  [[nodiscard]] SoftDirection soft_direction(Vector free) const;

  const Model& model_;
  const Assembler& assembler_;
  LinearSolver& solver_;
  CancelCallback beat_;
  Vector gradient_;
  Vector values_;
  Vector shifted_;
  Mass units_;
  Configuration here_;
};

/// A vector without structure, always the same, to start an iteration from.
Vector unstructured_vector(Index size);

}  // namespace der
