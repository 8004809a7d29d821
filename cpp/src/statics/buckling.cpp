#include <algorithm>
#include <array>
#include <cmath>

#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/stretched_edges.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/loads/external_force.hpp"
#include "der/statics/equilibrium_failure.hpp"
#include "der/statics/modes.hpp"
#include "der/statics/potential.hpp"
#include "der/statics/stiffness.hpp"

namespace der {
namespace {

/// An edge of the unloaded shape, as its stretch element sees it, and the effect of the loads.
struct LoadedEdge {
  std::array<Index, 4> dofs{};
  Vec2 turn;              ///< gradient of its direction angle by its vector [1/m]
  double length = 0.0;    ///< [m]
  double strain = 0.0;    ///< to first order in the load factor
  double tension = 0.0;   ///< [N], likewise
  double rotation = 0.0;  ///< [rad], likewise

  /// How much a displacement turns the edge [rad].
  [[nodiscard]] double turned_by(const Vector& displacement) const {
    return turn.dot(Stretch<2>::edge(gather(dofs, displacement)));
  }
};

std::vector<LoadedEdge> loaded_edges(const Model& model, const Configuration& here,
                                     const Vector& displacement) {
  std::vector<LoadedEdge> edges;
  for_each_stretched_edge(
      *model.elements, [&](const EffectiveEdge& effective, const Stretch<2>::Constants& c) {
        const Vec2 e = effective.vector(here);
        const Vec2 change = Stretch<2>::edge(gather(effective.dofs, displacement));
        LoadedEdge& edge = edges.emplace_back();
        edge.dofs = effective.dofs;
        edge.length = e.norm();
        edge.turn = direction_gradient(e, 1.0 / e.squaredNorm());
        edge.strain = e.dot(change) / (edge.length * c.rest_length);
        edge.tension = c.EA * edge.strain;
        edge.rotation = edge.turn.dot(change);
      });
  return edges;
}

template <class Member>
double largest(const std::vector<LoadedEdge>& edges, Member member) {
  double result = 0.0;
  for (const LoadedEdge& edge : edges) result = std::max(result, std::abs(edge.*member));
  return result;
}

/// K1 in the layout of a linear solver: the sum of tension * length * turn turn'.
Vector initial_stress_stiffness(const Model& model, const MatrixLayout& layout,
                                const std::vector<LoadedEdge>& edges) {
  Vector values = Vector::Zero(layout.num_values() + 1);
  for (const LoadedEdge& edge : edges) {
    Eigen::Vector4d slope;  // of the direction angle
    slope << -edge.turn, edge.turn;
    for (int column = 0; column < 4; ++column) {
      for (int row = column; row < 4; ++row) {
        const Index slot = layout.slot_or_spare(model.dofs.free_index(edge.dofs[to_size(row)]),
                                                model.dofs.free_index(edge.dofs[to_size(column)]));
        values[slot] += edge.tension * edge.length * slope[row] * slope[column];
      }
    }
  }
  return values;
}

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

/// The `count` modes of lowest factor of the tensions of `edges`; fewer if there are not so many.
std::vector<BucklingMode> buckling_modes(const Model& model, LinearSolver& solver, const Vector& k0,
                                         const std::vector<LoadedEdge>& edges,
                                         const Configuration& here, int count) {
  const Vector k1 = initial_stress_stiffness(model, solver.layout(), edges);
  // Factors are sought in units in which both matrices are of a size, so that no load is too large
  // or too small. As K0 is positive definite beyond rounding, none is less than that.
  const auto entries = [&](const Vector& values) {
    return values.head(solver.layout().num_values()).lpNorm<Eigen::Infinity>();
  };
  const double unit = entries(k0) / entries(k1);
  constexpr double kLeast = 1e-18;
  constexpr double kMost = 1e8;
  Pencil pencil(solver, k0, unit * k1);
  const Index available = std::min<Index>(count, pencil.critical_below(kMost));
  std::vector<BucklingMode> modes;
  std::vector<Vector> same;  // shapes of the current factor
  double low = kLeast;
  double before = 0.0;
  for (Index i = 0; i < available; ++i) {
    const double factor = pencil.bisect(i, low, kMost);
    if (factor > before * (1.0 + 1e-9)) same.clear();
    same.push_back(pencil.shape(factor, same, model.num_free()));
    Vector shape = over_all_dofs(model, same.back());
    // Taken element by element, the quotient keeps the digits of slender rods.
    double released = 0.0;
    for (const LoadedEdge& edge : edges) {
      const double turned = edge.turned_by(shape);
      released -= edge.tension * edge.length * turned * turned;
    }
    const double exact = second_variation(model, here, shape) / released;
    // Where K1 is much larger than K0, its rounding errors cause spurious critical factors.
    if (!(std::abs(exact / (unit * factor) - 1.0) < 0.5)) break;
    Eigen::Index main = 0;
    shape.cwiseAbs().maxCoeff(&main);
    modes.push_back({exact, shape / shape[main]});
    before = factor;
    low = factor * (1.0 - 1e-12);
  }
  std::sort(modes.begin(), modes.end(),
            [](const auto& a, const auto& b) { return a.load_factor < b.load_factor; });
  return modes;
}

}  // namespace

LinearBuckling linear_buckling(const Model& model, const Assembler& assembler, LinearSolver& solver,
                               const State& state, int count) {
  const Vector no_extra = Vector::Zero(model.num_dofs());
  Stiffness stiffness(model, assembler, solver);
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
  if (stability.unstable_directions + stability.neutral_directions + stability.unknown_directions >
      0) {
    throw NotConvergedError(
        "the structure without its loads is not stable: it has no buckling loads",
        status_of(EquilibriumFailure::NotHeld));
  }
  Vector step = loaded - unloaded;
  stiffness.factorize();
  stiffness.solve(step);
  auto edges = loaded_edges(model, here, over_all_dofs(model, step));

  LinearBuckling result;
  result.rotation = largest(edges, &LoadedEdge::rotation);
  result.strain = largest(edges, &LoadedEdge::strain);
  const double noise = stiffness.rounding() * step.lpNorm<Eigen::Infinity>();
  if (largest(edges, &LoadedEdge::tension) <= noise) return result;

  const auto modes_of = [&](const std::vector<LoadedEdge>& of, int most) {
    return buckling_modes(model, solver, stiffness.values(), of, here, most);
  };
  result.modes = modes_of(edges, count);
  if (result.modes.empty()) {
    for (LoadedEdge& edge : edges) edge.tension = -edge.tension;
    result.reversed = !modes_of(edges, 1).empty();
  }
  return result;
}

}  // namespace der
