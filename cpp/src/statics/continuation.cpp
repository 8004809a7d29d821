#include "der/statics/continuation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/loads/loads.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/solvers/predicted_tension.hpp"
#include "der/statics/potential.hpp"

namespace der {
namespace {

/// Newton iterations of one point; more mean that the step is too long.
constexpr int kMaxIterations = 12;
/// A point found in fewer iterations lets the step grow, in more shrink.
constexpr int kEasyIterations = 4;
constexpr int kHardIterations = 7;
/// The last Newton step of a point, in arc length: the next one would be its square.
constexpr double kLastStep = 1e-7;
/// The path may turn by this much from point to point [cosine].
constexpr double kLargestBend = 0.9;
/// No clamp turns by more than this from point to point [rad].
constexpr double kLargestTurn = 1.0;
/// Steps shorter than this, against the largest, end a branch.
constexpr double kShortestStep = 1e-7;
/// Events are located to this, against the step in which they lie ...
constexpr double kEventPlace = 1e-11;
/// ... and no two of them are told apart that are nearer than this.
constexpr double kSameEvent = 1e-6;
/// Least stretch of a path, against the largest step, on which events are one.
constexpr double kOnePlace = 1e-4;
/// Longest stretch over which a singular stiffness is looked for.
constexpr double kFarthestReach = 0.1;
/// Two bifurcations nearer than this, against the largest step, are one, met on two paths: where
/// the equations are singular what Newton leaves of the residual moves a point by its square root
/// ...
constexpr double kSamePlace = 1e-2;
/// ... and any other point that is nearer than this to a path lies on it.
constexpr double kSamePath = 1e-5;
/// A path comes back to a place after no less than this many of the largest steps.
constexpr double kShortestLoop = 3.0;
/// A path stays nearer than this to the line between two neighbours, against its length.
constexpr double kBulge = 0.25;
/// The first step of a branch, against the largest.
constexpr double kFirstStep = 0.2;
/// Points to either side of a located event that are farther apart than this, against the largest
/// step, lie on different paths.
constexpr double kJump = 1e-3;

/// Free degrees of freedom and the factor.
struct Extended {
  Vector x;
  double factor = 0.0;
};

/// A point on its way to the path: what the steps need of it.
struct Node {
  Extended at;
  Extended tangent;
  Vector positions;
  Vector turns;  // of the followed edges [rad]
  Stability stability;
  [[nodiscard]] bool rising() const { return tangent.factor > 0.0; }
};

class Follower {
 public:
  Follower(Model& model, const LoadPath& loads, const Assembler& assembler, LinearSolver& solver,
           const ContinuationOptions& options)
      : model_(model),
        loads_(loads),
        assembler_(assembler),
        options_(options),
        stiffness_(model, assembler, solver),
        tension_(model, assembler),
        range_(options.to - options.from) {}

  std::vector<PathBranch> run(const State& start) {
    begin(start);
    Node first = node_at({start.positions(model_.free_dofs), options_.from});
    set_metric(first);
    orient_to_the_end(first);
    follow(first, std::nullopt, 0);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      if (crossings_[i].depth < options_.branching) follow_from(i);
    }
    return std::move(branches_);
  }

 private:
  // The metric: <a, b> = weight a.x b.x + a.factor b.factor / range^2.

  [[nodiscard]] double dot(const Extended& a, const Extended& b) const {
    return weight_ * a.x.dot(b.x) + a.factor * b.factor / (range_ * range_);
  }
  [[nodiscard]] double norm(const Extended& a) const { return std::sqrt(dot(a, a)); }
  static Extended combine(const Extended& a, double factor, const Extended& b) {
    return {a.x + factor * b.x, a.factor + factor * b.factor};
  }

  void begin(const State& start) {
    positions_ = start.positions;
    turns_ = start.turns;
    largest_turn_ = 0.0;
    for (const RodLayout& rod : model_.rods) {
      for (const Clamp& clamp : rod.clamps) {
        if (clamp.rotation < 0) continue;
        largest_turn_ = std::max(largest_turn_, std::abs(loads_.change_of(clamp.rotation)));
      }
    }
    weight_ = 1.0 / (model_.num_nodes * model_.size * model_.size);
  }

  /// Displacements count as much as the factor does in the first linear response, within bounds.
  void set_metric(Node& first) {
    constexpr double kMostWeight = 20.0;
    const double share = std::abs(first.tangent.factor / range_);
    const double motion = std::sqrt(std::max(0.0, 1.0 - share * share));
    const double scale = std::clamp(motion > 0.0 ? share / motion : kMostWeight, 1.0, kMostWeight);
    weight_ *= scale * scale;
    first.tangent = unit(first.tangent);
  }

  [[nodiscard]] Extended unit(Extended a) const {
    const double length = norm(a);
    a.x /= length;
    a.factor /= length;
    return a;
  }

  // Equations.

  /// Full positions with the held degrees of freedom where the factor has them.
  void place(const Extended& point) {
    loads_.apply(point.factor, model_);
    model_.controls.evaluate(0.0, controls_);
    enter_turns(model_, turns_, controls_);
    apply_prescribed_motion(model_, controls_, positions_);
    positions_(model_.free_dofs) = point.x;
  }

  /// Sets the residual and the stiffness of the point.
  void evaluate(const Extended& point) {
    place(point);
    external_force(model_, controls_, Vector::Zero(model_.num_dofs()), force_);
    stiffness_.evaluate(positions_, controls_);
    residual_ = (stiffness_.gradient() - force_)(model_.free_dofs);
    force_scale_ =
        std::max(stiffness_.gradient().lpNorm<Eigen::Infinity>(), force_.lpNorm<Eigen::Infinity>());
  }

  Vector residual_at(const Extended& point) {
    place(point);
    external_force(model_, controls_, Vector::Zero(model_.num_dofs()), force_);
    Vector gradient(model_.num_dofs());
    assembler_.gradient(positions_, controls_, gradient);
    return (gradient - force_)(model_.free_dofs);
  }

  /// Derivative of the residual by the factor. Forces and moments are linear in it, so that a long
  /// step is exact; a moving support needs a short one.
  Vector factor_derivative(const Extended& point) {
    const double step = (loads_.is_linear() ? 1.0 : 1e-6) * std::abs(range_);
    Extended forward = point;
    Extended backward = point;
    forward.factor += step;
    backward.factor -= step;
    return (residual_at(forward) - residual_at(backward)) / (2.0 * step);
  }

  /// Tangent of the path at a point just evaluated, of unit length, factor rising. The inertia is
  /// that of the stiffness itself, without a margin for rounding, which would move the events.
  Extended tangent(const Extended& point, Stability& stability) {
    const Vector derivative = factor_derivative(point);
    stability.unstable_directions = stiffness_.factorize().negative_pivots;
    Extended result{-derivative, 1.0};
    stiffness_.solve(result.x);
    return unit(result);
  }

  Node node_at(const Extended& point) {
    evaluate(point);
    Node node;
    node.at = point;
    node.positions = positions_;
    node.turns = turns_;
    follow_turns(model_, positions_, node.turns);
    node.tangent = tangent(point, node.stability);
    return node;
  }

  /// Newton on the plane normal to `normal` through `base + step * normal`, from `guess`. Nothing
  /// if it does not converge. `iterations` says how hard it was.
  std::optional<Extended> solve_on_plane(const Extended& base, const Extended& normal, double step,
                                         Extended guess, int& iterations) {
    evaluate(guess);
    for (iterations = 1; iterations <= kMaxIterations; ++iterations) {
      const Vector derivative = factor_derivative(guess);
      place(guess);
      if (!stiffness_.factorize().factorised) return std::nullopt;
      Vector along = -residual_;
      Vector across = -derivative;
      stiffness_.solve(along);
      stiffness_.solve(across);
      const double miss = dot(normal, combine(guess, -1.0, base)) - step;
      const double range2 = range_ * range_;
      const double slope = weight_ * normal.x.dot(across) + normal.factor / range2;
      Extended change;
      change.factor = (-miss - weight_ * normal.x.dot(along)) / slope;
      change.x = along + change.factor * across;
      const double length = norm(change);
      if (!std::isfinite(length) || length > 10.0 * std::max(step, 1e-3)) return std::nullopt;
      guess = combine(guess, 1.0, change);
      evaluate(guess);
      const double allowed = std::max(options_.newton.residual_tolerance * force_scale_,
                                      stiffness_.rounding() * model_.size);
      if (length < kLastStep && residual_.lpNorm<Eigen::Infinity>() <= allowed) return guess;
      tension_.use(positions_, change.x, stiffness_.values());
    }
    return std::nullopt;
  }

  /// The point of the path at arc length `step` from `from`.
  std::optional<Node> next(const Node& from, double step, int& iterations) {
    turns_ = from.turns;
    const auto found = solve_on_plane(from.at, from.tangent, step,
                                      combine(from.at, step, from.tangent), iterations);
    if (!found) return std::nullopt;
    Node node = node_at(*found);
    if (dot(node.tangent, from.tangent) < 0.0) reverse(node.tangent);
    return node;
  }

  static void reverse(Extended& direction) {
    direction.x = -direction.x;
    direction.factor = -direction.factor;
  }
  void orient_to_the_end(Node& node) const {
    if (node.tangent.factor * range_ < 0.0) reverse(node.tangent);
  }

  // Paths.

  static bool same_state(const Node& a, const Node& b) {
    return a.rising() == b.rising() &&
           a.stability.unstable_directions == b.stability.unstable_directions;
  }

  /// Where the path turns in the factor, or directions gain or lose their stability.
  struct Located {
    double step = 0.0;  // from the node before
    Node node;
    bool turns = false;
    Index lost_directions = 0;
    double reach = 0.0;  // to either side, within which the place is not known
    /// At a limit point the factor turns and a direction loses its stability. Where only one of the
    /// two happens another path crosses: on a branch that passes through a symmetric bifurcation
    /// again the factor turns, but both of its sides are alike.
    [[nodiscard]] PathEvent event() const {
      return turns && lost_directions != 0 ? PathEvent::Fold : PathEvent::Bifurcation;
    }
  };

  /// Finds the events between `start` + `low` and `start` + `high` by bisection. `before` and
  /// `after` are the nodes there; places are told apart against the length `whole` of the first
  /// interval. False if the nodes lie on different paths.
  bool locate(const Node& start, double whole, double low, Node before, double high, Node after,
              std::vector<Located>& events) {
    if (same_state(before, after)) return true;
    int iterations = 0;
    while (high - low > kEventPlace * whole) {
      const double middle = 0.5 * (low + high);
      const auto found = next(start, middle, iterations);
      if (!found) break;
      if (same_state(*found, before)) {
        low = middle;
        before = *found;
      } else if (same_state(*found, after)) {
        high = middle;
        after = *found;
      } else if (high - low > kSameEvent * whole) {
        return locate(start, whole, low, before, middle, *found, events) &&
               locate(start, whole, middle, *found, high, after, events);
      } else {
        break;  // the factor turns where the stiffness loses its rank: one event, to rounding
      }
    }
    if (norm(combine(after.at, -1.0, before.at)) > kJump * options_.largest_step) {
      return false;
    }
    const Index lost = after.stability.unstable_directions - before.stability.unstable_directions;
    events.push_back({high, after, before.rising() != after.rising(), lost, 0.0});
    return true;
  }

  /// Whether an eigenvalue of the stiffness `step` ahead of `start` is zero to rounding.
  bool is_singular(const Node& start, double step) {
    int iterations = 0;
    if (!next(start, step, iterations)) return true;
    const double rounding = stiffness_.rounding();
    return stiffness_.factorize(rounding).negative_pivots !=
           stiffness_.factorize(-rounding).negative_pivots;
  }

  /// How far from an event its place is uncertain. Where a path crosses another one at which its
  /// factor turns, an eigenvalue vanishes with the square of the way, so that the inertia and the
  /// sense of the tangent are made of rounding for the square root of rounding to either side.
  double reach_of(const Located& located, const Node& start) {
    double reach = kOnePlace * options_.largest_step;
    while (reach < kFarthestReach * options_.largest_step &&
           (is_singular(start, located.step - reach) || is_singular(start, located.step + reach))) {
      reach *= 2.0;
    }
    return reach;
  }

  /// Makes one of events at one place.
  void merge(std::vector<Located>& events, const Node& start) {
    std::vector<Located> merged;
    for (Located& located : events) {
      located.reach = reach_of(located, start);
      if (merged.empty() || located.step - merged.back().step > located.reach) {
        merged.push_back(std::move(located));
        continue;
      }
      Located& place = merged.back();
      place.turns = place.turns != located.turns;
      place.lost_directions += located.lost_directions;
      place.reach = std::max(place.reach, located.reach);
      place.node = std::move(located.node);
    }
    for (Located& located : merged) {
      // Nor is the tangent at a bifurcation known from there.
      if (located.event() == PathEvent::Bifurcation) located.node.tangent = start.tangent;
    }
    events = std::move(merged);
  }

  void add_point(PathBranch& branch, const Node& node, double arc, PathEvent event) const {
    branch.points.push_back(
        {node.at.factor, arc, node.stability, event, node.positions, node.turns});
  }

  /// How far the factor is on its way: 0 at `from`, 1 at `to`.
  [[nodiscard]] double progress(double factor) const { return (factor - options_.from) / range_; }

  /// The point at which the path passes a factor, from a node near it.
  std::optional<Node> node_at_factor(const Node& near, double factor, const Extended& guess) {
    Extended normal{Vector::Zero(model_.num_free()), std::abs(range_)};
    const Extended base{near.at.x, 0.0};
    int iterations = 0;
    Extended first = guess;
    first.factor = factor;
    turns_ = near.turns;
    const auto found = solve_on_plane(base, normal, factor / std::abs(range_), first, iterations);
    if (!found) return std::nullopt;
    Node node = node_at(*found);
    if (dot(node.tangent, near.tangent) < 0.0) reverse(node.tangent);
    return node;
  }

  /// Whether the way between two neighbours leads past a point.
  [[nodiscard]] bool passes(const Extended& point, const Node& from, const Node& to) const {
    const Extended back = combine(point, -1.0, from.at);
    const Extended ahead = combine(point, -1.0, to.at);
    const double length = norm(combine(to.at, -1.0, from.at));
    return dot(back, from.tangent) >= 0.0 && dot(ahead, to.tangent) <= 0.0 &&
           std::max(norm(back), norm(ahead)) < 1.5 * length;
  }

  /// Whether a point `step` ahead may be the next one: the path bends little up to it, and nothing
  /// turns so far that whole turns could be lost.
  [[nodiscard]] bool is_near(const Node& node, double step, const Node& found) const {
    const double turn = largest_turn_ * std::abs(found.at.factor - node.at.factor);
    return turn <= kLargestTurn && edge_turned_too_far(model_, found.positions, node.turns) < 0 &&
           dot(found.tangent, node.tangent) >= kLargestBend &&
           step >= kLargestBend * norm(combine(found.at, -1.0, node.at));
  }

  /// If the factor passes `to`, or goes as far to the other side, on the way to `found`, moves
  /// `found`, `reached` ahead, to that place and says so.
  std::string stop_at_limits(const Node& node, Node& found, double& reached) {
    const double before = progress(node.at.factor);
    const double now = progress(found.at.factor);
    for (const double limit : {1.0, -1.0}) {
      if ((before - limit) * (now - limit) >= 0.0 || before == limit) continue;
      const double share = (limit - before) / (now - before);
      const auto last = node_at_factor(node, options_.from + limit * range_,
                                       combine(node.at, share, combine(found.at, -1.0, node.at)));
      if (last) {
        found = *last;
        reached = dot(node.tangent, combine(found.at, -1.0, node.at));
      }
      return limit > 0.0 ? "last factor" : "as far to the other side";
    }
    return "";
  }

  // Branches.

  /// A bifurcation, and the branch on which it was met first.
  struct Crossing {
    Node node;
    int branch = 0;
    double arc = 0.0;          // on that branch
    int depth = 0;             // bifurcations between that branch and the first one
    bool followed = false;     // whether its branches have been
    std::vector<Node> beyond;  // points behind it, of branches that end here
  };

  /// Number of the bifurcation at a place `arc` along a branch, if it is known.
  [[nodiscard]] std::optional<std::size_t> crossing_at(const Located& place, int branch,
                                                       double arc) const {
    const double same = kSamePlace * options_.largest_step + 2.0 * place.reach;
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      const Crossing& known = crossings_[i];
      const bool came_back =
          known.branch != branch || arc - known.arc > kShortestLoop * options_.largest_step;
      if (came_back && norm(combine(known.node.at, -1.0, place.node.at)) < same) return i;
    }
    return std::nullopt;
  }

  [[nodiscard]] Extended extended(const PathPoint& point) const {
    return {point.positions(model_.free_dofs), point.factor};
  }

  /// Whether a point lies on a branch that is over: whether Newton leads to it from the line that
  /// joins two neighbours, on the plane across that line. Neither of them need be near.
  bool is_traced(const Extended& point) {
    for (const PathBranch& branch : branches_) {
      for (std::size_t i = 0; i + 1 < branch.points.size(); ++i) {
        turns_ = branch.points[i].turns;
        if (lies_between(extended(branch.points[i]), extended(branch.points[i + 1]), point)) {
          return true;
        }
      }
    }
    return false;
  }

  bool lies_between(const Extended& from, const Extended& to, const Extended& point) {
    const Extended line = combine(to, -1.0, from);
    const double length = norm(line);
    const double same = kSamePath * options_.largest_step;
    if (length < same) return false;
    const Extended direction = unit(line);
    const double along = dot(combine(point, -1.0, from), direction);
    if (along < -same || along > length + same) return false;
    const Extended foot = combine(from, along, direction);
    if (norm(combine(point, -1.0, foot)) > kBulge * length) return false;
    int iterations = 0;
    const auto found = solve_on_plane(from, direction, along, foot, iterations);
    return found && norm(combine(point, -1.0, *found)) < same;
  }

  /// A branch while it is followed.
  struct Trace {
    PathBranch branch;
    int number = 0;
    std::optional<std::size_t> root;  // the bifurcation at which it begins
    int depth = 0;                    // bifurcations between it and the first branch
    Extended origin;
    double arc = 0.0;
  };

  /// A branch whose first point besides its root, if it has one, is `first`.
  Trace begin_trace(const Node& first, std::optional<std::size_t> root, int side) {
    Trace trace;
    trace.number = static_cast<int>(branches_.size());
    trace.root = root;
    trace.branch.side = side;
    trace.origin = first.at;
    if (root) {
      const Crossing& start = crossings_[*root];
      trace.branch.parent = start.branch;
      trace.origin = start.node.at;
      trace.depth = start.depth + 1;
      add_point(trace.branch, start.node, 0.0, PathEvent::None);
    }
    trace.arc = norm(combine(first.at, -1.0, trace.origin));
    add_point(trace.branch, first, trace.arc, PathEvent::None);
    return trace;
  }

  /// Whether a branch that meets a known bifurcation on its way to `found` ends there: what lies
  /// beyond has been traced, or will be from there.
  bool ends_at(Crossing& crossing, const Trace& trace, const Node& found) {
    if (crossing.branch == trace.number) return false;
    int iterations = 0;
    const auto beyond = next(found, kFirstStep * options_.largest_step, iterations);
    if (!beyond) return false;
    if (crossing.depth < options_.branching && !crossing.followed) {
      crossing.beyond.push_back(*beyond);
      return true;
    }
    return is_traced(beyond->at);
  }

  /// Puts the events on the way to `found` into a branch, each the first time that it is met. Ends
  /// the branch where it goes over into what has been traced.
  void add_events(const std::vector<Located>& events, const Node& found, Trace& trace) {
    for (const Located& located : events) {
      const double arc = trace.arc + located.step;
      const bool bifurcates = located.event() == PathEvent::Bifurcation;
      const auto known = bifurcates ? crossing_at(located, trace.number, arc) : std::nullopt;
      if (!known) {
        add_point(trace.branch, located.node, arc, located.event());
        if (bifurcates) {
          crossings_.push_back({located.node, trace.number, arc, trace.depth, false, {}});
        }
      } else if (Crossing& crossing = crossings_[*known]; ends_at(crossing, trace, found)) {
        add_point(trace.branch, crossing.node, arc, PathEvent::None);
        trace.branch.ending =
            known == trace.root ? "closed loop" : fmt::format("meets branch {}", crossing.branch);
        return;
      }
    }
  }

  /// Follows a branch from `node` on, whose tangent shows the way. `root` is the number of the
  /// bifurcation at which it begins, if any.
  void follow(Node node, std::optional<std::size_t> root, int side) {
    Trace trace = begin_trace(node, root, side);
    PathBranch& branch = trace.branch;
    double step = kFirstStep * options_.largest_step;
    while (branch.ending.empty()) {
      if (static_cast<int>(branch.points.size()) >= options_.max_points) {
        branch.ending = "largest number of points";
        break;
      }
      int iterations = 0;
      auto found = next(node, step, iterations);
      double reached = step;
      std::string ending;
      std::vector<Located> events;
      if (found && is_near(node, step, *found)) ending = stop_at_limits(node, *found, reached);
      if (!found || !is_near(node, reached, *found) ||
          !locate(node, reached, 0.0, node, reached, *found, events)) {
        step *= 0.5;
        if (step < kShortestStep * options_.largest_step) branch.ending = "no further point found";
        continue;
      }
      merge(events, node);
      add_events(events, *found, trace);
      if (!branch.ending.empty()) break;
      branch.ending = ending;
      trace.arc += reached;
      add_point(branch, *found, trace.arc, PathEvent::None);
      if (trace.arc > kShortestLoop * options_.largest_step && passes(trace.origin, node, *found)) {
        branch.ending = "closed loop";
      }
      node = *found;
      if (iterations <= kEasyIterations) step *= 1.5;
      if (iterations >= kHardIterations) step *= 0.7;
      step = std::min(step, options_.largest_step);
    }
    branches_.push_back(std::move(branch));
  }

  /// Follows all branches that leave a bifurcation and have not been traced: to both sides of the
  /// path it lies on, and on from those that end there.
  void follow_from(std::size_t number) {
    const auto follow_new = [&](const Node& node, int side) {
      if (!is_traced(node.at)) follow(node, number, side);
    };
    for (const int side : {1, -1}) {
      if (const auto node = first_point(crossings_[number].node, side)) follow_new(*node, side);
    }
    for (std::size_t i = 0; i < crossings_[number].beyond.size(); ++i) {
      follow_new(Node(crossings_[number].beyond[i]), 0);
    }
    crossings_[number].followed = true;
  }

  /// The first point of the branch that leaves `bifurcation` to one side of the path it lies on.
  std::optional<Node> first_point(const Node& bifurcation, int side) {
    turns_ = bifurcation.turns;
    evaluate(bifurcation.at);
    Extended across{stiffness_.nearest_to_zero().direction, 0.0};
    across = combine(across, -dot(across, bifurcation.tangent), bifurcation.tangent);
    across = unit(across);
    if (side < 0) reverse(across);
    for (double step = 0.5 * options_.largest_step; step > 1e-4 * options_.largest_step;
         step *= 0.5) {
      int iterations = 0;
      const auto found = solve_on_plane(bifurcation.at, across, step,
                                        combine(bifurcation.at, step, across), iterations);
      if (!found) continue;
      Node node = node_at(*found);
      const Extended way = combine(node.at, -1.0, bifurcation.at);
      if (dot(node.tangent, way) < 0.0) reverse(node.tangent);
      return node;
    }
    return std::nullopt;
  }

  Model& model_;
  const LoadPath& loads_;
  const Assembler& assembler_;
  const ContinuationOptions& options_;
  Stiffness stiffness_;
  PredictedTension tension_;
  double range_ = 1.0;
  double weight_ = 1.0;
  Vector positions_;
  Vector turns_;               // of the point from which the search for the next one starts [rad]
  double largest_turn_ = 0.0;  // of a clamp, by a unit of the factor [rad]
  Vector controls_;
  Vector force_;
  Vector residual_;
  double force_scale_ = 0.0;
  std::vector<PathBranch> branches_;
  std::vector<Crossing> crossings_;
};

}  // namespace

std::vector<PathBranch> follow_path(Model& model, const LoadPath& loads, const Assembler& assembler,
                                    LinearSolver& solver, const ContinuationOptions& options,
                                    const State& start) {
  return Follower(model, loads, assembler, solver, options).run(start);
}

}  // namespace der
