#include "der/statics/equilibrium.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

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
/// A last Newton step that moves a node by more than this share of the size is too long to trust.
constexpr double kLastStep = 1e-1;
/// Share of the size to which the last step must show the equilibrium.
constexpr double kKnown = 1e-6;
/// Share of the acting forces that a neutral equilibrium may leave unbalanced.
constexpr double kBalanced = 1e-3;
/// Potentials closer than this, against the largest force times the size, are the same.
constexpr double kSamePotential = 1e-13;
/// Supports move by no more than this share of an edge at once.
constexpr double kSupportStep = 0.3;
/// By as much [rad] may the edge beside a clamp be bent away from it and the clamp still not have
/// moved.
constexpr double kTurned = 1.0;
/// The first step of supports that move farther, as a share of the whole.
constexpr double kFirstSupportShare = 1e-9;
/// The first load step, as a share of the whole.
constexpr double kSmallestShare = 1.0 / 256.0;
/// An edge is along an axis if the difference across it is less than this share of its length.
constexpr double kAligned = 1e-9;
/// Largest turns of an edge [rad] of the bent shapes from which the search starts again.
constexpr std::array<double, 3> kBentStarts{0.3, 1.0, 3.0};
/// Directions of the straight ones.
constexpr int kStraightStarts = 8;
/// Turning angle [rad] at a node beyond which the rod is folded: at pi the curvature has no sign.
constexpr double kFolded = 3.0;
/// Share of its rest length at which an edge counts as pressed to a point.
constexpr double kCollapsed = 1e-2;

/// By how much a unit moment turns the softest spring against turning [1/(N m)].
double softest_turn(const Model& model) {
  double softest = 0.0;
  for (const RodLayout& rod : model.rods) {
    for (const MomentPlace& place : rod.moment_places) {
      if (place.stiffness > 0.0) softest = std::max(softest, 1.0 / place.stiffness);
    }
  }
  return softest;
}

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
        stage_(model),
        turns_(state.turns) {
    stage_.mass = {Vector::Ones(model.num_dofs()), {}};
    turned_.setZero(static_cast<Index>(std::get<ElementList<PlanarMoment>>(model.elements).size()));
    for (const RodLayout& rod : model.rods) {
      if (rod.EI > 0.0) softness_ = std::max(softness_, rod.rest_length() / rod.EI);
    }
    softness_ += softest_turn(model);
    evaluate_controls(model, state, state.time, stage_.controls);
    external_force(model, stage_.controls, state.extra_force, stage_.force);
    spring_travel_ = spring_travel(model, stage_.force.lpNorm<1>());
  }

  EquilibriumReport run(State& state) {
    Vector x = state.positions;
    start_ = {x, turns_};
    if (const std::string unheld = find_unheld_part(model_, stage_.force); !unheld.empty()) {
      fail("not_held", unheld);
      return report_;
    }
    move_supports(x);
    start_ = {x, turns_};
    report_.converged = newton(x) || descend(x, report_.force_scale / model_.size) ||
                        step_loads(x) || swing(x) || start_elsewhere(x);
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
    if (report_.converged && !whole_turns_.empty() && whole_turns(x) != whole_turns_) {
      report_.converged = false;
      fail("folded",
           "a clamp that turns does not take the rod along: a node folds over on the way, the mesh "
           "is too coarse for the bend there");
    }
    if (report_.converged) {
      state.positions = x;
      state.turns = turns_;
    }
    return report_;
  }

 private:
  /// A shape with the turns of its followed edges, which it does not say itself.
  struct Wound {
    Vector positions;
    Vector turns;
  };

  void set_turns(const Vector& turns) {
    turns_ = turns;
    enter_turns(model_, turns_, stage_.controls);
  }
  /// Follows the turns to `x`, which is not far from where they were followed to last.
  void follow_turns_to(const Vector& x) {
    follow_turns(model_, x, turns_);
    enter_turns(model_, turns_, stage_.controls);
  }
  void go_to(const Wound& shape, Vector& x) {
    x = shape.positions;
    set_turns(shape.turns);
  }

  /// Puts the held degrees of freedom to their places and turns the clamps. Where that would fold
  /// or crush the edges beside them, the shape follows on the way: first in tiny steps that double,
  /// so that a rod that is pressed buckles near its first buckling load and not, crushed, in a high
  /// mode, whose folds it would keep; then in short steps. A clamp that turns by more than a step
  /// takes the rod along: at once it would be known up to whole turns only.
  void move_supports(Vector& x) {
    const bool as_drawn = x(model_.free_dofs) == model_.initial_positions(model_.free_dofs);
    if (as_drawn) {
      x = model_.initial_positions;
      set_turns(Vector::Zero(turns_.size()));
    }
    follow_turns_to(x);
    Vector target = x;
    place_held(model_, stage_.controls, target);
    const Vector whole = target - x;
    const Vector turned = stage_.controls;
    const Vector turns = turned - (as_drawn ? drawn_controls() : present_controls());
    const double longest = kSupportStep / std::max(largest_edge_change(model_, whole),
                                                   turns.lpNorm<Eigen::Infinity>());
    stage_.controls = turned - turns;
    if (!turns.isZero(0.0)) whole_turns_ = whole_turns(x);
    double step = longest < 1.0 ? kFirstSupportShare : 1.0;
    for (double share = step; share < 1.0; share += step) {
      x += step * whole;
      stage_.controls = turned - (1.0 - share) * turns;
      enter_turns(model_, turns_, stage_.controls);
      follow(x);
      step = std::min({2.0 * step, longest, 1.0 - share});
    }
    stage_.controls = turned;
    place_held(model_, stage_.controls, x);
    follow_turns_to(x);
  }

  /// By how many whole turns the rods wind up between their clamps besides what the directions of
  /// the clamps say. It stays the same as long as no node folds over.
  std::vector<double> whole_turns(const Vector& x) const {
    std::vector<double> turns;
    for (const RodLayout& rod : model_.rods) {
      for (const Clamp& first : rod.clamps) {
        for (const Clamp& last : rod.clamps) {
          if (first.place >= last.place) continue;
          const double between =
              turning_angle(rod, first, last, x) - tangent_angle(last) + tangent_angle(first);
          turns.push_back(std::round(between / (2.0 * kPi)));
        }
      }
    }
    return turns;
  }

  double tangent_angle(const Clamp& clamp) const {
    return clamp.direction + (clamp.rotation >= 0 ? stage_.controls[clamp.rotation] : 0.0);
  }

  /// Sum of the turning angles [rad] at all nodes from a clamp to another, these included.
  double turning_angle(const RodLayout& rod, const Clamp& first, const Clamp& last,
                       const Vector& x) const {
    const auto tangent = [&](const Clamp& clamp) {
      return Vec2(std::cos(tangent_angle(clamp)), std::sin(tangent_angle(clamp)));
    };
    double sum = 0.0;
    Vec2 before = tangent(first);
    for (Index edge = first.place; edge < last.place; ++edge) {
      const Link link = link_of(rod, edge, model_);
      const Vec2 here =
          link.vector(x, link.first.turn(stage_.controls), link.last.turn(stage_.controls));
      sum += angle_between(before, here);
      before = here;
    }
    return sum + angle_between(before, tangent(last));
  }

  /// The controls, with the clamps as drawn.
  Vector drawn_controls() const {
    Vector controls = stage_.controls;
    for_each_turning_clamp([&](const Clamp& clamp) { controls[clamp.rotation] = 0.0; });
    return controls;
  }

  /// The controls, with each clamp turned as the edge beside it has.
  Vector present_controls() const {
    Vector controls = stage_.controls;
    for_each_turning_clamp([&](const Clamp& clamp) {
      const double turn = turns_[clamp.followed];
      if (std::abs(turn - controls[clamp.rotation]) > kTurned) controls[clamp.rotation] = turn;
    });
    return controls;
  }

  template <class Use>
  void for_each_turning_clamp(const Use& use) const {
    for (const RodLayout& rod : model_.rods) {
      for (const Clamp& clamp : rod.clamps) {
        if (clamp.rotation >= 0) use(clamp);
      }
    }
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
    go_to(start_, x);
    bool found = true;
    for (double share = kSmallestShare; found && share <= 1.0; share *= 2.0) {
      stage_.force = share * whole.force;
      for (const auto& moment : moments.constants) {
        stage_.controls[moment.moment] = share * whole.controls[moment.moment];
      }
      found = descend(x, share * scale / model_.size);
    }
    stage_ = whole;
    enter_turns(model_, turns_, stage_.controls);
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
    go_to(start_, x);
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
      follow_turns_to(x);
      if (turn < 0.5 * kSwingTurn) step *= 1.2;
      if (turn < turn_for_newton) {
        if (finish(x)) return true;
        turn_for_newton *= 0.5;
      }
    }
    go_to(start_, x);
    fail(status, failure);
    return false;
  }

  /// Starts again from other shapes: bent along the softest direction, to both sides, as a load
  /// that presses a straight rod to a point may let a bent one give way; then laid out straight,
  /// which undoes crumpled ones. Returns false and leaves `x` at the start if none helps.
  bool start_elsewhere(Vector& x) {
    const auto [status, failure] = std::make_pair(report_.status, report_.failure);
    if (status == "unbounded") return false;
    stiffness_.evaluate(start_.positions, stage_.controls);
    const Vector soft = bend(stiffness_.softest());
    std::vector<Vector> starts;
    for (const double turn : kBentStarts) {
      for (const double side : {1.0, -1.0})
        starts.emplace_back(start_.positions + side * turn * soft);
    }
    for (int i = 0; i < kStraightStarts; ++i) {
      starts.push_back(laid_out(2.0 * kPi * i / kStraightStarts));
    }
    for (Vector& start : starts) {
      go_to({std::move(start), start_.turns}, x);
      follow_turns_to(x);
      if (descend(x, report_.force_scale / model_.size)) return true;
    }
    go_to(start_, x);
    fail(status, failure);
    return false;
  }

  /// Every rod straight from its first node in one direction [rad], but for what is held.
  Vector laid_out(double direction) const {
    Vector x = start_.positions;
    for (const RodLayout& rod : model_.rods) {
      const Vec2 first = start_.positions.segment<2>(model_.dof(rod.nodes.front(), 0));
      for (std::size_t i = 0; i < rod.nodes.size(); ++i) {
        x.segment<2>(model_.dof(rod.nodes[i], 0)) =
            first + rod.arc_length[i] * Vec2(std::cos(direction), std::sin(direction));
      }
    }
    place_held(model_, stage_.controls, x);
    return x;
  }

  /// The displacement along a direction that changes an edge by 1 at most.
  Vector bend(const SoftDirection& soft) const {
    Vector displacement = Vector::Zero(model_.num_dofs());
    displacement(model_.free_dofs) = soft.direction;
    return displacement / largest_edge_change(model_, displacement);
  }

  void fail(std::string status, std::string why) {
    report_.status = std::move(status);
    report_.failure = std::move(why);
  }

  /// Sets the verdict on `x`, which gets its last digits.
  void judge(Vector& x) {
    stiffness_.evaluate(x, stage_.controls);
    report_.stability = stiffness_.stability();
    report_.status.clear();
    report_.failure.clear();
    if (report_.stability.neutral_directions == 0) polish(x);
    report_.residual =
        (stage_.force - stiffness_.gradient())(model_.free_dofs).lpNorm<Eigen::Infinity>();
    // In a neutral equilibrium a Newton step says nothing: there the forces must.
    if (report_.stability.neutral_directions > 0 &&
        report_.residual > kBalanced * report_.force_scale) {
      lose_in_rounding();
    }
    report_.largest_turning_angle = largest_turning_angle(model_, x);
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
    if ((x - start_.positions).lpNorm<Eigen::Infinity>() >
        kDrift * (model_.size + spring_travel_)) {
      fail("unbounded", "the structure moves away: nothing holds it");
      x = before;
      return false;
    }
    if (shortest_edge(x) < kCollapsed || turned_inside_out(x)) {
      fail("collapsed",
           "every way that was tried presses a part of a rod together to a point, past which it is "
           "no rod: the load may be too great for its stiffness against shortening, EA");
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

  /// Whether an edge that supports guide along an axis, so that it cannot turn, points backwards.
  bool turned_inside_out(const Vector& x) const {
    const auto held = [&](Index dof) { return model_.free_index[at(dof)] < 0; };
    return std::any_of(model_.edges.begin(), model_.edges.end(), [&](const Edge& edge) {
      const auto now = gather(edge.dofs, x);
      const auto drawn = gather(edge.dofs, model_.initial_positions);
      const Vec2 e = now.tail<2>() - now.head<2>();
      const Vec2 e0 = drawn.tail<2>() - drawn.head<2>();
      for (const int c : {0, 1}) {
        const bool guided = held(edge.dofs[at(c)]) && held(edge.dofs[at(2 + c)]);
        const bool slides = !held(edge.dofs[at(1 - c)]) || !held(edge.dofs[at(3 - c)]);
        const bool aligned = std::abs(e[c]) < kAligned * edge.rest_length;
        if (guided && slides && aligned && e[1 - c] * e0[1 - c] < 0.0) return true;
      }
      return false;
    });
  }

  bool newton(Vector& x) {
    stage_.inertia = 0.0;
    if (!solve(x)) return false;
    follow_turns_to(x);
    return true;
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
      follow_turns_to(x);
      fallen_ += *fall;
      if (turn < turn_for_newton) {
        if (finish(x)) return true;
        turn_for_newton *= 0.3;
      }
      if (turn < 1.0) resistance *= turn < 0.1 ? easing * easing : easing;
      easing = std::max(kEasing, 0.9 * easing);
    }
    if (report_.status == "not_converged" && largest_turning_angle(model_, x) > kFolded) {
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
      if (edge_turned_too_far(model_, next, turns_) >= 0) continue;
      const double fall = change(x, next);
      if (fall <= same_potential()) return fall;
    }
    return std::nullopt;
  }

  /// Plain Newton to the equilibrium at the end of a descent, if it is near and not uphill.
  bool finish(Vector& x) {
    const Vector turns = turns_;
    Vector last = x;
    if (newton(last) && largest_edge_change(model_, last - x) <= kLastTurn) {
      const double fall = change(x, last);
      if (fall <= same_potential()) {
        x = last;
        fallen_ += fall;
        return true;
      }
    }
    set_turns(turns);
    return false;
  }

  /// Takes a few more Newton steps as long as they get shorter: the residual of stiff stretching
  /// ends at its rounding error when the soft bending can still be solved better. Steps that remain
  /// long are those of no equilibrium: the residual, then, was all rounding error.
  void polish(Vector& x) {
    constexpr int kSteps = 8;
    double step = std::numeric_limits<double>::infinity();
    Vector correction;
    for (int i = 0; i < kSteps; ++i) {
      correction = (stage_.force - stiffness_.gradient())(model_.free_dofs);
      const double next = solve_last(correction) ? correction.lpNorm<Eigen::Infinity>() : step;
      if (!(next < 0.5 * step)) break;
      step = next;
      if (step > kLastStep * model_.size) break;
      for (Index k = 0; k < model_.num_free(); ++k) x[model_.free_dofs[at(k)]] += correction[k];
      stiffness_.evaluate(x, stage_.controls);
    }
    if (!(step <= kKnown * model_.size)) lose_in_rounding();
  }

  void lose_in_rounding() {
    report_.converged = false;
    fail("too_fine",
         "the forces balance to their rounding error, and that hides the shape: the mesh is too "
         "fine, or the rod too stiff against stretching, for double precision");
  }

  /// Solves for a Newton step at the end. False if it cannot be had.
  bool solve_last(Vector& step) {
    const Stability& stability = report_.stability;
    if (stability.doubtful_directions > 0 && stability.unstable_directions == 0) {
      return stiffness_.solve_by_elements(step);
    }
    if (!stiffness_.factorize().factorised) return false;
    stiffness_.solve(step);
    return true;
  }

  /// Goes down from the saddle `x` to both sides of its softest direction and sets `x` to the
  /// equilibrium of lower potential; of the first side where both are the same.
  bool leave_saddle(Vector& x) {
    stiffness_.evaluate(x, stage_.controls);
    const SoftDirection soft = stiffness_.softest();
    const Vector direction = bend(soft);
    const double same = 1e-6;  // of the fall
    const Vector turns = turns_;
    for (const double turn : {0.05, 0.001}) {
      std::optional<Wound> best;
      double best_fall = -same_potential();
      for (const double side : {1.0, -1.0}) {
        Vector here = x + side * turn * direction;
        set_turns(turns);
        const double push = change(x, here);
        if (!descend(here, 2.0 * std::abs(soft.curvature), kEasingAtSaddle)) continue;
        const double fall = push + fallen_;
        if (fall < best_fall - same * std::abs(best_fall)) {
          best = {here, turns_};
          best_fall = fall;
        }
      }
      if (best) {
        go_to(*best, x);
        ++report_.saddles_left;
        return true;
      }
    }
    set_turns(turns);
    return false;
  }

  const Model& model_;
  const EquilibriumOptions& options_;
  Newton newton_;
  Stiffness stiffness_;
  Stage stage_;
  Vector turns_;  // [rad] of the followed edges
  Wound start_;
  double softness_ = 0.0;            // largest turn by a unit moment [1/(N m)]
  double spring_travel_ = 0.0;       // [m]
  std::vector<double> whole_turns_;  // before clamps turn; empty if none does
  Vector turned_;                    // [rad] of each edge with a moment in the last descent
  double fallen_ = 0.0;              // [J] in the last descent
  EquilibriumReport report_;
};

}  // namespace

EquilibriumReport find_equilibrium(const Model& model, const Assembler& assembler,
                                   LinearSolver& solver, const EquilibriumOptions& options,
                                   State& state) {
  return Search(model, assembler, solver, options, state).run(state);
}

}  // namespace der
