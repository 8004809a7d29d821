#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "der/core/error.hpp"
#include "der/loads/external_force.hpp"
#include "der/statics/equilibrium_failure.hpp"
#include "der/statics/initial_stress.hpp"
#include "der/statics/modes.hpp"
#include "der/statics/neutral_motions.hpp"
#include "der/statics/potential.hpp"
#include "der/statics/stiffness.hpp"

namespace der {
namespace {

/// K0 + a K1, and the number of critical factors below a. Shapes have the length 1 where angles
/// count times the length of the model: `units` are the unit masses of the free degrees of freedom.
class Pencil {
 public:
  Pencil(LinearSolver& solver, Vector k0, Vector k1, Vector units, const CancelCallback& beat)
      : solver_(solver),
        k0_(std::move(k0)),
        k1_(std::move(k1)),
        units_(std::move(units)),
        beat_(beat) {}
  Index critical_below(double factor) {
    if (beat_) beat_();
    return solver_.factorize(k0_ + factor * k1_).negative_pivots;
  }
  /// Raises a factor until more than `index` critical ones are below it; false if there are no
  /// more. It goes no higher than it has to: of a matrix that all but consists of K1, which may
  /// have zeros along its diagonal, rounding decides the pivots.
  bool raise(double& factor, Index index) {
    constexpr double kMost = 1e8;
    constexpr double kStride = 4.0;
    while (factor < kMost && critical_below(factor) <= index) factor *= kStride;
    return factor < kMost;
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
  Vector shape(double factor, const std::vector<Vector>& others) {
    solver_.factorize(k0_ + factor * (1.0 + 1e-11) * k1_);
    Vector x =
        unstructured_vector(static_cast<Index>(units_.size())).cwiseQuotient(units_.cwiseSqrt());
    for (int i = 0; i < 4; ++i) {
      make_orthogonal(others, x);
      x = units_.cwiseProduct(x);
      solver_.solve(x);
    }
    make_orthogonal(others, x);
    return x;
  }

 private:
  /// To shapes of length 1; makes its length 1 as well.
  void make_orthogonal(const std::vector<Vector>& others, Vector& x) const {
    for (const Vector& other : others) x -= other.dot(units_.cwiseProduct(x)) * other;
    x /= std::sqrt(x.dot(units_.cwiseProduct(x)));
  }

  LinearSolver& solver_;
  Vector k0_;
  Vector k1_;
  Vector units_;
  const CancelCallback& beat_;
};

/// The factor a at which K0 + a K1 + a^2 K2 is critical for a shape that is critical without K2,
/// from the quadratic forms of the shape. K2 is small; on meshes so coarse that it is not, it is
/// left out.
double critical_factor(double k0, double k1, double k2) {
  const double inside = k1 * k1 - 4.0 * k0 * k2;
  return inside > 0.0 ? -2.0 * k0 / (k1 + std::copysign(std::sqrt(inside), k1)) : -k0 / k1;
}

/// The shape with its largest displacement 1; the largest angle of a shape that only twists.
Vector scaled(const Model& model, const Vector& shape) {
  const auto largest = [](const auto& values) {
    Eigen::Index main = 0;
    values.cwiseAbs().maxCoeff(&main);
    return values[main];
  };
  const double displacement = largest(shape.head(model.dofs.num_positions()));
  constexpr double kNone = 1e-9;
  const double all = largest(shape);
  return shape / (std::abs(displacement) > kNone * std::abs(all) ? displacement : all);
}

NotConvergedError unstable_without_loads() {
  return NotConvergedError(
      "the structure without its loads is not stable: it has no buckling loads",
      status_of(EquilibriumFailure::NotHeld));
}

/// Throws unless the stresses have no part in motions that nothing resists.
void check_left_alone(const NeutralMotions& motions) {
  using Stresses = NeutralMotions::Stresses;
  if (motions.stresses == Stresses::LeaveThem) return;
  const bool upset = motions.stresses == Stresses::UpsetThem;
  throw NotConvergedError(
      fmt::format("nothing resists a motion of rod '{}' while there are no loads, as its spin "
                  "between two pins, and {}: hold it, a section by 'clamp: true'{}",
                  motions.rod,
                  upset ? "the smallest loads make it unstable, so that there is no other buckling"
                        : "linear theory does not decide what the loads make of it",
                  upset ? "" : ", or follow the path ('analysis: continuation')"),
      status_of(EquilibriumFailure::NotHeld));
}

NotConvergedError hidden_buckling() {
  return NotConvergedError(
      "the buckling loads are lost in the rounding errors of the stiffness of the shortest edges: "
      "give the rods fewer nodes, longer edges, or a smaller EA",
      status_of(EquilibriumFailure::LostInRoundoff));
}

}  // namespace

std::vector<BucklingMode> buckling_modes(const Model& model, const Stiffness& stiffness,
                                         LinearSolver& solver, const Configuration& here,
                                         const InitialStress& stress, int count,
                                         const CancelCallback& beat) {
  const Vector& k0 = stiffness.values();
  const Vector k1 = stress.stiffness(model, solver.layout());
  // Factors are sought in units in which both matrices are of a size, so that no load is too large
  // or too small. As K0 is positive definite beyond rounding, none is less than that.
  const auto entries = [&](const Vector& values) {
    return values.head(solver.layout().num_values()).lpNorm<Eigen::Infinity>();
  };
  if (entries(k1) == 0.0) return {};
  constexpr double kTrusted = 0.02;  // relative change of a factor from the matrix to the elements
  constexpr double kHidden = 0.01;   // share of a factor that the rounding of K0 hides
  const double unit = entries(k0) / entries(k1);
  constexpr double kLeast = 1e-18;
  Pencil pencil(solver, k0, unit * k1, model.dofs.unit_masses()(model.dofs.free()), beat);
  std::vector<BucklingMode> modes;
  std::vector<Vector> same;  // shapes of the current factor
  double low = kLeast;
  double high = kLeast;
  double before = 0.0;
  for (Index i = 0; i < count && pencil.raise(high, i); ++i) {
    const double factor = pencil.bisect(i, low, high);
    if (factor > before * (1.0 + 1e-9)) same.clear();
    same.push_back(pencil.shape(factor, same));
    const Vector shape = over_all_dofs(model, same.back());
    // Taken element by element, the quotient keeps the digits of slender rods.
    const double k0_form = second_variation(model, here, shape);
    const double exact = -k0_form / stress.variation(shape);
    if (!(std::abs(exact / (unit * factor) - 1.0) < kTrusted)) {
      // Where K1 is much larger than K0, its rounding errors cause spurious critical factors.
      if (stiffness.rounding() < kHidden * unit * factor * std::abs(stress.variation(shape))) break;
      throw hidden_buckling();
    }
    modes.push_back(
        {critical_factor(k0_form, stress.variation(shape), stress.second_variation(shape)),
         scaled(model, shape)});
    before = factor;
    low = factor * (1.0 - 1e-12);
  }
  std::sort(modes.begin(), modes.end(),
            [](const auto& a, const auto& b) { return a.load_factor < b.load_factor; });
  return modes;
}

LinearBuckling linear_buckling(const Model& model, const Assembler& assembler, LinearSolver& solver,
                               const State& state, int count, const CancelCallback& beat) {
  const Vector no_extra = Vector::Zero(model.num_dofs());
  Stiffness stiffness(model, assembler, solver, beat);
  Configuration here{state.positions, {}};
  Vector force;
  // Sets the stiffness at a load factor; returns the unbalanced force.
  const auto evaluate = [&](double factor) -> Vector {
    here.load_factor = factor;
    here.controls = model.load_variation->controls.at(factor);
    enter_followed(model, state.followed, here.controls);
    external_force(model, here, no_extra, force);
    stiffness.evaluate(here);
    return (force - stiffness.gradient())(model.dofs.free());
  };
  const Vector loaded = evaluate(1.0);
  const Vector unloaded = evaluate(0.0);
  const Stability stability = stiffness.stability();
  if (stability.unstable_directions > 0) throw unstable_without_loads();
  if (stability.unknown_directions > 0) throw hidden_buckling();
  Vector step = loaded - unloaded;
  Eigen::MatrixXd neutral;
  if (stability.neutral_directions > 0) {
    neutral = stiffness.softest_directions(stability.neutral_directions);
    if (does_work(model, step, neutral)) throw unstable_without_loads();
    stiffness.hold(neutral);
  }
  stiffness.factorize();
  stiffness.solve(step);

  LinearBuckling result;
  result.response = over_all_dofs(model, step);
  InitialStress stress(model, here, result.response);
  result.rotation = stress.rotation();
  result.strain = stress.strain();
  const double noise = stiffness.rounding() * model.dofs.largest_motion(result.response);
  if (stress.largest() <= noise) return result;
  if (neutral.cols() > 0) check_left_alone(judge_neutral_motions(model, neutral, stress));

  const auto modes_of = [&](int most) {
    return buckling_modes(model, stiffness, solver, here, stress, most, beat);
  };
  result.modes = modes_of(count);
  if (result.modes.empty()) {
    stress.reverse();
    result.reversed = !modes_of(1).empty();
  }
  return result;
}

}  // namespace der
