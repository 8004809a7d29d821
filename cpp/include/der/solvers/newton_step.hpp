#pragma once

#include <algorithm>
#include <limits>

#include "der/solvers/newton_problem.hpp"

namespace der {

// How Newton's method goes on after a step: of one simulation, or of each member in lanes.

/// Plain Newton steps that have not converged by then rarely do.
constexpr int kFullStepIterations = 12;
/// A step below this share of the size may well be the last: look before building a new matrix.
constexpr double kNearSolution = 1e-3;

/// A few rounding errors of numbers up to this.
inline double rounding_of(double largest) {
  return 8.0 * std::numeric_limits<double>::epsilon() * largest;
}

/// The share of a step that changes an edge by `change`, over its length, that is admissible: as an
/// angle [rad], beyond it the quadratic model says nothing.
inline StepBound bound_of_change(double change) {
  constexpr double kLargestEdgeChange = 0.7;
  if (change <= kLargestEdgeChange) return {1.0, change};
  return {kLargestEdgeChange / change, kLargestEdgeChange};
}

/// A step that was taken.
struct NewtonStep {
  double length = 0.0;           ///< largest motion [m]
  double change = 0.0;           ///< StepBound::change
  double residual_before = 0.0;  ///< [N]
  double residual = 0.0;         ///< behind it [N]
};

struct NewtonProgress {
  bool is_short = false;    ///< the next step would be below the tolerance
  bool is_stalled = false;  ///< steps are suspected to be those of rounding
};

/// `step_tolerance` is against the model's `size` [m]; `position_rounding()` is the rounding error
/// [m] of positions, looked at where need be.
template <class PositionRounding>
NewtonProgress progress_of(const NewtonStep& step, double step_tolerance, double size,
                           const PositionRounding& position_rounding) {
  // Where the residual no longer falls below this share of the one before, steps this short [size]
  // may be those of rounding, which no iteration makes shorter.
  constexpr double kStalledFall = 0.5;
  constexpr double kStalledStep = 1e-9;
  // The next step is about as much smaller than this one as the residual has become; but the
  // residual of stiff stretching hides that of soft bending, so also no less than what the
  // rotation of the edges, which a Newton step leaves out, makes of this step.
  const double fall = step.residual_before > 0.0 ? step.residual / step.residual_before : 0.0;
  const double next_step = step.length * std::min(1.0, std::max(fall, step.change));
  // Far from the origin positions themselves are only known to their rounding.
  return {next_step <= step_tolerance * size || next_step <= position_rounding(),
          fall > kStalledFall && step.length <= kStalledStep * size};
}

}  // namespace der
