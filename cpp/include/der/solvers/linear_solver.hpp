#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "der/assembly/pattern.hpp"
#include "der/core/types.hpp"

namespace der {

/// The inertia of A from a factorisation A = L D L^T: by Sylvester's law of inertia D has as many
/// negative entries as A has negative eigenvalues.
struct Inertia {
  bool factorised = false;    ///< false: a pivot vanished or was not a number
  Index negative_pivots = 0;  ///< number of negative eigenvalues
  Index failed_at = -1;       ///< free degree of freedom of the vanishing pivot
};

/// Direct solver for the symmetric, possibly indefinite system matrix. Called once a Newton
/// iteration, so a virtual call costs nothing here.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// Where the assembler has to put the entries of the lower triangle.
  [[nodiscard]] virtual const MatrixLayout& layout() const = 0;
  /// Factorises the matrix whose entries lie in `values` as `layout` says; `values` is kept.
  virtual Inertia factorize(const Vector& values) = 0;
  /// Solves A x = b in place, with the last factorisation.
  virtual void solve(Vector& b) = 0;
};

/// The order in which a band solver takes the rows of a chain.
enum class Elimination {
  /// From both ends to the middle, which is faster.
  FromBothEnds,
  /// From the start. Where rods are held at their starts, as most are, no part that nothing holds
  /// is eliminated before the rest. Such a part has no stiffness of its own; the rounding error of
  /// its stretching stiffness takes the place of that. It shows beyond EA L^2/EI = 1e12, and in
  /// equilibria, where no inertia comes in addition.
  FromStart
};

/// A solver chosen, and why.
struct LinearSolverChoice {
  std::unique_ptr<LinearSolver> solver;
  std::string reason;
};

/// `name` is one of `linear_solver_names()`; `auto` takes the band solver where the band is narrow.
/// `pattern` must outlive the solver. Throws Error for a solver that is not built in.
LinearSolverChoice make_linear_solver(const std::string& name, const Pattern& pattern,
                                      Elimination order = Elimination::FromStart);

}  // namespace der
