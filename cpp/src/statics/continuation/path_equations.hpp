#pragma once

#include <cstdint>
#include <optional>

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/solvers/linear_solver.hpp"
#include "der/solvers/newton.hpp"
#include "der/solvers/predicted_tension.hpp"
#include "der/statics/continuation.hpp"
#include "der/statics/stiffness.hpp"
#include "statics/continuation/path_metric.hpp"

namespace der::statics {

/// An equilibrium on the path, with the tangent of the path there.
struct PathNode {
  PathPosition at;
  PathPosition tangent;  ///< of unit length
  Vector positions;      ///< all degrees of freedom [m]
  Vector followed;       ///< of the followed edges [rad]
  Stability stability;
  Stability out_of_plane;  ///< (PlaneMonitor)
  [[nodiscard]] bool rising() const { return tangent.factor > 0.0; }
};

/// The equations of equilibrium with the load factor as one more unknown, and Newton's method for
/// them on a plane across the path. `followed` is always that of a point nearby: the chart in which
/// angles of sections count.
class PathEquations {
 public:
  /// `positions` give the values of held degrees of freedom that do not vary.
  PathEquations(const Model& model, const Assembler& assembler, LinearSolver& solver,
                const ContinuationOptions& options, PathMetric metric, Vector positions);

  [[nodiscard]] const PathMetric& metric() const { return metric_; }
  /// Iterations of all solves so far.
  [[nodiscard]] std::int64_t newton_iterations() const { return newton_iterations_; }

  /// A shape in another chart, that of the frames `chart`: its free degrees of freedom, the angles
  /// of sections from those frames. Two points of a path have the same angles from frames that
  /// followed it from one to the other, but points that were reached on two ways have not.
  [[nodiscard]] PathPosition in_chart(const Vector& chart, double factor, const Vector& positions,
                                      const Vector& followed);

  /// The shape and the controls at a node.
  [[nodiscard]] const Configuration& configuration_at(const PathNode& node);

  /// Sets the metric from the tangent of the first node, and makes that tangent a unit one again.
  void set_metric(PathNode& first);

  /// The node at an equilibrium, with the factor rising along its tangent.
  PathNode node_at(const Vector& followed, const PathPosition& point);

  /// Newton's method on the plane normal to `normal` through `base + step * normal`, from `guess`.
  /// Returns nothing if it does not converge; sets `iterations` to the number of iterations.
  std::optional<PathPosition> solve_on_plane(const Vector& followed, const PathPosition& base,
                                             const PathPosition& normal, double step,
                                             PathPosition guess, int& iterations);

  /// The node at arc length `step` from `from`, along the same sense of the path.
  std::optional<PathNode> next(const PathNode& from, double step, int& iterations);

  /// The node at which the path passes a load factor, from a node near it.
  std::optional<PathNode> node_at_factor(const PathNode& near, double factor, PathPosition guess);

  /// Whether an eigenvalue of the stiffness `step` ahead of `start` is zero to rounding, or no
  /// equilibrium is found there.
  bool is_singular(const PathNode& start, double step);

  /// The direction of the eigenvector whose eigenvalue is nearest to zero, at a constant factor.
  PathPosition null_direction(const PathNode& node);

 private:
  void place(const Vector& followed, const PathPosition& point);
  void evaluate(const Vector& followed, const PathPosition& point);
  [[nodiscard]] double unbalanced() const;  // [N], at the point evaluated last
  Vector residual_at(const Vector& followed, const PathPosition& point);
  Vector factor_derivative(const Vector& followed, const PathPosition& point);
  PathPosition tangent(const Vector& followed, const PathPosition& point, Stability& stability);

  const Model& model_;
  const LoadVariation& loads_;
  const Assembler& assembler_;
  NewtonOptions options_;
  PathMetric metric_;
  Stiffness stiffness_;
  PredictedTension tension_;
  Configuration here_;
  Vector no_extra_;  // [N] what programs add to the loads: nothing
  Vector force_;
  Vector residual_;
  double force_scale_ = 0.0;
  std::int64_t newton_iterations_ = 0;
  std::optional<bool> by_pivots_;  // whether these tell the stability; set at the first node
};

}  // namespace der::statics
