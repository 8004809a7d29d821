#include <algorithm>
#include <cmath>

#include "der/core/error.hpp"
#include "der/loads/loads.hpp"
#include "der/statics/modes.hpp"
#include "der/statics/potential.hpp"
#include "der/statics/stiffness.hpp"

namespace der {
namespace {

/// Load factors beyond this are none.
constexpr double kLargestFactor = 1e12;
constexpr double kSmallestFactor = 1e-12;
/// Largest change of an edge by the first-order displacement from which the stiffness's derivative
/// is taken: small against 1, large against rounding.
constexpr double kProbe = 1e-5;

/// K0 + a K1, and the number of critical factors below a.
class Pencil {
 public:
  Pencil(LinearSolver& solver, Vector k0, Vector k1)
      : solver_(solver), k0_(std::move(k0)), k1_(std::move(k1)) {}
  Index critical_below(double factor) {
    return solver_.factorize(k0_ + factor * k1_).negative_pivots;
  }
  /// Critical factor number `index`, counted from 0, by bisection between `low` and `high`.
  double bisect(Index index, double low, double high) {
    constexpr double kRelative = 1e-13;
    while (high - low > kRelative * high) {
      const double middle = low < 0.5 * high ? std::sqrt(low * high) : 0.5 * (low + high);
      (critical_below(middle) > index ? high : low) = middle;
    }
    return 0.5 * (low + high);
  }
  /// The shape that is critical at `factor`: inverse iteration, kept orthogonal to `others`, which
  /// belong to the same factor.
  Vector shape(double factor, const std::vector<Vector>& others, Index size) {
    solver_.factorize(k0_ + factor * (1.0 + 1e-11) * k1_);
    Vector x = unstructured_vector(size);
    for (int i = 0; i < 4; ++i) {
      for (const Vector& other : others) x -= other.dot(x) * other;
      x.normalize();
      solver_.solve(x);
    }
    for (const Vector& other : others) x -= other.dot(x) * other;
    return x.normalized();
  }

 private:
  LinearSolver& solver_;
  Vector k0_;
  Vector k1_;
};

}  // namespace

std::vector<BucklingMode> buckling_modes(Model& model, const LoadPath& loads,
                                         const Assembler& assembler, LinearSolver& solver,
                                         const Vector& positions, int count) {
  const FactorGuard back_to_the_scene(loads, model);
  Stiffness stiffness(model, assembler, solver);
  Vector controls;
  Vector force;
  // Sets the stiffness at a load factor and a shape; returns the unbalanced force.
  const auto evaluate = [&](double factor, const Vector& shape) -> Vector {
    loads.apply(factor, model);
    model.controls.evaluate(0.0, controls);
    external_force(model, controls, Vector::Zero(model.num_dofs()), force);
    stiffness.evaluate(shape, controls);
    return (force - stiffness.gradient())(model.free_dofs);
  };
  const Vector loaded = evaluate(1.0, positions);
  const Vector unloaded = evaluate(0.0, positions);
  const Stability stability = stiffness.stability();
  if (stability.unstable_directions + stability.neutral_directions > 0) {
    throw NotConvergedError(
        "the structure without its loads is not stable: it has no buckling loads", "not_held");
  }
  const Vector k0 = stiffness.values();
  Vector step = loaded - unloaded;
  stiffness.factorize();
  stiffness.solve(step);
  Vector displacement = Vector::Zero(model.num_dofs());
  displacement(model.free_dofs) = step;
  const double change = largest_edge_change(model, displacement);
  if (change == 0.0) return {};

  const double probe = kProbe / change;
  evaluate(probe, positions + probe * displacement);
  Vector k1 = stiffness.values();
  evaluate(-probe, positions - probe * displacement);
  k1 = (k1 - stiffness.values()) / (2.0 * probe);

  Pencil pencil(solver, k0, k1);
  std::vector<BucklingMode> modes;
  std::vector<Vector> same;  // shapes of the factor at hand
  double low = kSmallestFactor;
  for (Index i = 0; i < std::min<Index>(count, model.num_free()); ++i) {
    double high = std::max(low, 1e-3);
    while (high < kLargestFactor && pencil.critical_below(high) <= i) {
      low = high;
      high *= 2.0;
    }
    if (high >= kLargestFactor) break;
    const double factor = pencil.bisect(i, low, high);
    if (!modes.empty() && factor > modes.back().load_factor * (1.0 + 1e-9)) same.clear();
    same.push_back(pencil.shape(factor, same, model.num_free()));
    Vector shape = Vector::Zero(model.num_dofs());
    shape(model.free_dofs) = same.back();
    Eigen::Index largest = 0;
    shape.cwiseAbs().maxCoeff(&largest);
    modes.push_back({factor, shape / shape[largest]});
    low = factor * (1.0 - 1e-12);
  }
  return modes;
}

}  // namespace der
