#include "der/statics/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "der/assembly/element_energy.hpp"
#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/loads/loads.hpp"
#include "der/statics/potential.hpp"
#include "der/statics/rigid_motion.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/supports.hpp"

namespace der {
namespace {

/// Pseudo-time steps of one descent.
constexpr int kMaxRelaxations = 500;
/// Saddles left in a row before the search gives up; each has a lower potential than the last.
constexpr int kMaxSaddles = 30;
/// A structure that has moved this many times its size, and farther than its springs give way, is
/// held by nothing.
constexpr double kDrift = 100.0;
/// What is left of the resistance after a step that turns the rod; gentler where steps fail.
constexpr double kEasing = 0.3;
/// The same beside a saddle, where the potential is not convex.
constexpr double kEasingAtSaddle = 0.7;
/// No pseudo-time step turns an edge by more [rad]: beyond it lies another valley.
constexpr double kLargestTurn = 2.0;
/// Of a swing: steps, turn of an edge [rad] in one of them, shortest one against the first, and
/// friction times the first.
constexpr int kMaxSwings = 3000;
constexpr double kSwingTurn = 0.2;
constexpr double kShortestSwing = 1e-6;
constexpr double kFriction = 0.3;
/// A Newton step to the end of a descent must not change an edge by more than this.
constexpr double kLastTurn = 0.5;
/// Potentials closer than this, against the largest force times the size, are the same.
constexpr double kSamePotential = 1e-13;
/// Supports move by no more than this share of an edge at once.
constexpr double kSupportStep = 0.3;
/// The first step of supports that move farther, as a share of the whole.
constexpr double kFirstSupportShare = 1e-9;
/// The first load step, as a share of the whole.
constexpr double kSmallestShare = 1.0 / 256.0;
/// Turning angle [rad] at a node beyond which the rod is folded: at pi the curvature has no sign.
constexpr double kFolded = 3.0;
/// Share of its rest length at which an edge counts as pressed to a point.
constexpr double kCollapsed = 1e-2;

/// How far [m] springs can let the structure move under `load` [N], counted from the drawn shape.
double spring_travel(const Model& model, double load) {
  double farthest = 0.0;
  for_each_list(model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (HoldsElement<Kernel>::value) {
      LocalTerm<Kernel::kDofs> drawn;
      for (std::size_t e = 0; e < list.size(); ++e) {
        Kernel::template evaluate<Derivatives::Energy>(
            list.constants[e], {}, gather(list.dofs[e], model.initial_positions), drawn);
        for (int c = 0; c < model.dimension; ++c) {
          if (!Kernel::holds(list.constants[e], c)) continue;
          const double stiffness = list.constants[e].stiffness[c];
          farthest =
              std::max(farthest, load / stiffness + std::sqrt(2.0 * drawn.energy / stiffness));
        }
      }
    }
  });
  return farthest;
}

class Search {
 public:
  Search(const Model& model, const Assembler& assembler, LinearSolver& solver,
         const EquilibriumOptions& options, const State& state)
      : model_(model),
        options_(options),
        newton_(model, assembler, solver, options.newton),
        stiffness_(model, assembler, solver),
        stage_(model) {
    stage_.mass = {Vector::Ones(model.num_dofs()), {}};
    turned_.setZero(static_cast<Index>(std::get<ElementList<PlanarMoment>>(model.elements).size()));
    for (const RodLayout& rod : model.rods) {
      if (rod.EI > 0.0) softness_ = std::max(softness_, rod.rest_length() / rod.EI);
    }
    model.controls.evaluate(state.time, state.ramps, stage_.controls);
    external_force(model, stage_.controls, state.extra_force, stage_.force);
    spring_travel_ = spring_travel(model, stage_.force.lpNorm<1>());
  }

  EquilibriumReport run(Vector& positions) {
    Vector x = positions;
    start_ = x;
    if (const std::string unheld = find_unheld_part(model_, stage_.force); !unheld.empty()) {
      fail("not_held", unheld);
      return report_;
    }
    move_supports(x);
    start_ = x;
    report_.converged =
        newton(x) || descend(x, report_.force_scale / model_.size) || step_loads(x) || swing(x);
    if (report_.converged) judge(x);
    while (report_.converged && options_.leave_saddles &&
           report_.stability.unstable_directions > 0) {
      if (report_.saddles_left == kMaxSaddles || !leave_saddle(x)) {
        report_.converged = false;
        fail("not_converged", "only unstable equilibria were found");
        break;
      }
      judge(x);
    }
    if (report_.converged) positions = x;
    return report_;
  }

 private:
  /// Puts the held degrees of freedom to their places. Where that would fold or crush the edges
  /// beside them, the shape follows on the way: first in tiny steps that double, so that a rod that
  /// is pressed buckles near its first buckling load and not, crushed, in a high mode, whose folds
  /// it would keep; then in short steps.
  void move_supports(Vector& x) {
    const bool as_drawn = x(model_.free_dofs) == model_.initial_positions(model_.free_dofs);
    if (as_drawn) x = model_.initial_positions;
    Vector target = x;
    place_held(model_, stage_.controls, target);
    const Vector whole = target - x;
    const double longest = kSupportStep / largest_edge_change(model_, whole);
    double step = longest < 1.0 ? kFirstSupportShare : 1.0;
    for (double share = step; share < 1.0; share += step) {
      x += step * whole;
      follow(x);
      step = std::min({2.0 * step, longest, 1.0 - share});
    }
    place_held(model_, stage_.controls, x);
  }

  /// Sets `x` to the stable equilibrium near it, as far as one is found.
  void follow(Vector& x) {
    if (!newton(x) && !descend(x, report_.force_scale / model_.size)) return;
    stiffness_.evaluate(x, stage_.controls);
    if (options_.leave_saddles && stiffness_.stability().unstable_directions > 0) leave_saddle(x);
  }

  /// Raises the loads from a small part to the whole, in doubling steps, each with a descent from
  /// the shape before: a shape that the whole load would crush gives way first. Returns false and
  /// leaves `x` at the start if that does not help.
  bool step_loads(Vector& x) {
    const Stage whole = stage_;
    const auto& moments = std::get<ElementList<PlanarMoment>>(model_.elements);
    const double scale = report_.force_scale;
    const auto [status, failure] = std::make_pair(report_.status, report_.failure);
    if (status == "unbounded") return false;
    x = start_;
    bool found = true;
    for (double share = kSmallestShare; found && share <= 1.0; share *= 2.0) {
      stage_.force = share * whole.force;
      for (const auto& moment : moments.constants) {
        stage_.controls[moment.moment] = share * whole.controls[moment.moment];
      }
      found = descend(x, share * scale / model_.size);
    }
    stage_ = whole;
    if (!found) fail(status, failure);  // that of the whole load says more
    return found;
  }

  /// Lets the structure swing from where it is drawn, with friction, in implicit Euler steps for
  /// unit masses. Without momentum the flow may end at a wall, where a node folds or an edge is
  /// crushed, past which the structure would swing on to an equilibrium. Returns false and leaves
  /// `x` at the start if it comes to no rest.
  bool swing(Vector& x) {
    const auto [status, failure] = std::make_pair(report_.status, report_.failure);
    if (status == "unbounded") return false;
    x = start_;
    Vector velocity = Vector::Zero(x.size());
    Vector next;
    stiffness_.evaluate(x, stage_.controls);
    const double acting = std::max(stage_.force.lpNorm<Eigen::Infinity>(),
                                   stiffness_.gradient().lpNorm<Eigen::Infinity>());
    double step = std::sqrt(model_.size / acting);
    const double friction = kFriction / step;
    const double shortest = kShortestSwing * step;
    double turn_for_newton = 0.1;
    for (int i = 0; i < kMaxSwings && step > shortest; ++i) {
      ++report_.relaxations;
      const double slowed = 1.0 + friction * step;
      stage_.inertia = slowed / (step * step);
      stage_.inertia_target = x + step / slowed * velocity;
      next = x;
      const bool solved = solve(next);
      const double turn = solved ? largest_edge_change(model_, next - x) : 0.0;
      if (!solved || turn > kSwingTurn) {
        step *= 0.5;
        continue;
      }
      velocity = (next - x) / step;
      x = next;
      if (turn < 0.5 * kSwingTurn) step *= 1.2;
      if (turn < turn_for_newton) {
        if (finish(x)) return true;
        turn_for_newton *= 0.5;
      }
    }
    x = start_;
    fail(status, failure);
    return false;
  }

  void fail(std::string status, std::string why) {
    report_.status = std::move(status);
    report_.failure = std::move(why);
  }

  void judge(Vector& x) {
    stiffness_.evaluate(x, stage_.controls);
    report_.stability = stiffness_.stability();
    if (report_.stability.neutral_directions == 0) polish(x);
    report_.residual =
        (stage_.force - stiffness_.gradient())(model_.free_dofs).lpNorm<Eigen::Infinity>();
    report_.sharpest_turn = sharpest_turn(model_, x);
    report_.status.clear();
    report_.failure.clear();
  }

  /// Solves for the balance of forces, those of the pseudo-time included.
  bool solve(Vector& x, bool downhill = false) {
    const Vector before = x;
    const NewtonReport report =
        downhill ? newton_.solve_downhill(stage_, x) : newton_.solve(stage_, x);
    report_.newton_iterations += report.iterations;
    report_.residual = report.residual;
    report_.force_scale = report.force_scale;
    if (!report.converged) {
      fail("not_converged", report.failure);
      return false;
    }
    if ((x - start_).lpNorm<Eigen::Infinity>() > kDrift * (model_.size + spring_travel_)) {
      fail("unbounded", "the structure moves away: nothing holds it");
      x = before;
      return false;
    }
    if (shortest_edge(x) < kCollapsed) {
      fail("collapsed",
           "a part of a rod is pressed together to a point: the load is greater than "
           "its stiffness against shortening, EA, can take");
      x = before;
      return false;
    }
    return true;
  }

  /// Length of the edge that is shortened most, against its rest length.
  double shortest_edge(const Vector& x) const {
    double shortest = 1.0;
    const auto compare = [&](const Vec2& e, double rest_length) {
      shortest = std::min(shortest, e.norm() / rest_length);
    };
    const auto& edges = std::get<ElementList<Stretch<2>>>(model_.elements);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const auto ends = gather(edges.dofs[e], x);
      compare(ends.tail<2>() - ends.head<2>(), edges.constants[e].rest_length);
    }
    const auto& links = std::get<ElementList<FromPivot<Stretch<2>>>>(model_.elements);
    for (std::size_t e = 0; e < links.size(); ++e) {
      const auto& c = links.constants[e];
      const Link link{links.dofs[e], c.first, c.last};
      compare(link.vector(x, c.first.turn(stage_.controls), c.last.turn(stage_.controls)),
              c.element.rest_length);
    }
    return shortest;
  }

  bool newton(Vector& x) {
    stage_.inertia = 0.0;
    return solve(x);
  }

  double change(const Vector& from, const Vector& to) const {
    return potential_change(model_, stage_.controls, stage_.force, from, to);
  }
  double same_potential() const { return kSamePotential * report_.force_scale * model_.size; }

  /// Follows the gradient flow from `x` to an equilibrium of lower potential, to which it sets `x`.
  /// `resistance` [N/m] is the inverse of the first pseudo-time step, `easing` what is left of it
  /// after a step. Returns false if it gets to none; `fallen_` is the change of the potential [J].
  bool descend(Vector& x, double resistance, double easing = kEasing) {
    constexpr double kFarTooMuch = 1e12;
    const double most = kFarTooMuch * std::max(resistance, report_.force_scale / model_.size);
    turned_.setZero();
    double turn_for_newton = 0.3;
    fallen_ = 0.0;
    Vector next;
    for (int i = 0; i < kMaxRelaxations && resistance <= most; ++i) {
      ++report_.relaxations;
      const std::optional<double> fall = relax(x, resistance, next);
      if (!fall) {
        resistance *= 4.0;
        easing = std::sqrt(easing);
        continue;
      }
      const double turn = largest_edge_change(model_, next - x);
      if (turns_without_end(x, next)) return false;
      x = next;
      fallen_ += *fall;
      if (turn < turn_for_newton) {
        if (finish(x)) return true;
        turn_for_newton *= 0.3;
      }
      if (turn < 1.0) resistance *= turn < 0.1 ? easing * easing : easing;
      easing = std::max(kEasing, 0.9 * easing);
    }
    if (report_.status == "not_converged" && sharpest_turn(model_, x) > kFolded) {
      fail("folded",
           "the rod folds back on itself at one node, where the curvature ends: the mesh is "
           "too coarse for this load");
    }
    return false;
  }

  /// Follows how far the edges with a moment have turned. A moment can wind up a rod by M L / EI;
  /// if it turns much further, nothing holds against it.
  bool turns_without_end(const Vector& from, const Vector& to) {
    const auto& moments = std::get<ElementList<PlanarMoment>>(model_.elements);
    for (std::size_t i = 0; i < moments.size(); ++i) {
      const auto before = gather(moments.dofs[i], from);
      const auto after = gather(moments.dofs[i], to);
      const Index n = static_cast<Index>(i);
      turned_[n] +=
          angle_between(before.tail<2>() - before.head<2>(), after.tail<2>() - after.head<2>());
      const double moment = std::abs(stage_.controls[moments.constants[i].moment]);
      if (std::abs(turned_[n]) > 4.0 * kPi + 2.0 * moment * softness_) {
        fail("unbounded", "a moment turns the rod on and on");
        return true;
      }
    }
    return false;
  }

  /// One pseudo-time step from `x` to `next`. Returns the change of the potential [J], or nothing
  /// if the step cannot be done, leads uphill or too far.
  std::optional<double> relax(const Vector& x, double resistance, Vector& next) {
    stage_.inertia = resistance;
    stage_.inertia_target = x;
    for (const bool downhill : {false, true}) {
      next = x;
      if (!solve(next, downhill) || largest_edge_change(model_, next - x) > kLargestTurn) continue;
      const double fall = change(x, next);
      if (fall <= same_potential()) return fall;
    }
    return std::nullopt;
  }

  /// Plain Newton to the equilibrium at the end of a descent, if it is near and not uphill.
  bool finish(Vector& x) {
    Vector last = x;
    if (!newton(last) || largest_edge_change(model_, last - x) > kLastTurn) return false;
    const double fall = change(x, last);
    if (fall > same_potential()) return false;
    x = last;
    fallen_ += fall;
    return true;
  }

  /// Takes a few more Newton steps as long as they get shorter: the residual of stiff stretching
  /// ends at its rounding error when the soft bending can still be solved better.
  void polish(Vector& x) {
    constexpr int kSteps = 3;
    double allowed = 1e-4 * model_.size;
    Vector residual;
    for (int i = 0; i < kSteps; ++i) {
      residual = (stage_.force - stiffness_.gradient())(model_.free_dofs);
      if (!stiffness_.factorize().factorised) return;
      stiffness_.solve(residual);
      const double step = residual.lpNorm<Eigen::Infinity>();
      if (!(step < allowed)) return;
      for (Index k = 0; k < model_.num_free(); ++k) x[model_.free_dofs[at(k)]] += residual[k];
      stiffness_.evaluate(x, stage_.controls);
      allowed = 0.5 * step;
    }
  }

  /// Goes down from the saddle `x` to both sides of its softest direction and sets `x` to the
  /// equilibrium of lower potential; of the first side where both are the same.
  bool leave_saddle(Vector& x) {
    stiffness_.evaluate(x, stage_.controls);
    const SoftDirection soft = stiffness_.softest();
    Vector direction = Vector::Zero(model_.num_dofs());
    for (Index i = 0; i < model_.num_free(); ++i) {
      direction[model_.free_dofs[at(i)]] = soft.direction[i];
    }
    direction /= largest_edge_change(model_, direction);
    const double same = 1e-6;  // of the fall
    for (const double turn : {0.05, 0.001}) {
      std::optional<Vector> best;
      double best_fall = -same_potential();
      for (const double side : {1.0, -1.0}) {
        Vector here = x + side * turn * direction;
        const double push = change(x, here);
        if (!descend(here, 2.0 * std::abs(soft.curvature), kEasingAtSaddle)) continue;
        const double fall = push + fallen_;
        if (fall < best_fall - same * std::abs(best_fall)) {
          best = here;
          best_fall = fall;
        }
      }
      if (best) {
        x = *best;
        ++report_.saddles_left;
        return true;
      }
    }
    return false;
  }

  const Model& model_;
  const EquilibriumOptions& options_;
  Newton newton_;
  Stiffness stiffness_;
  Stage stage_;
  Vector start_;
  double softness_ = 0.0;       // largest L / EI of a rod [1/(N m)]
  double spring_travel_ = 0.0;  // [m]
  Vector turned_;               // [rad] of each edge with a moment in the last descent
  double fallen_ = 0.0;         // [J] in the last descent
  EquilibriumReport report_;
};

}  // namespace

EquilibriumReport find_equilibrium(const Model& model, const Assembler& assembler,
                                   LinearSolver& solver, const EquilibriumOptions& options,
                                   const State& state, Vector& positions) {
  return Search(model, assembler, solver, options, state).run(positions);
}

}  // namespace der
