#include "der/statics/continuation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/loads/loads.hpp"
#include "der/solvers/predicted_tension.hpp"
#include "der/statics/potential.hpp"
#include "der/supports/supports.hpp"

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
/// Events that are nearer than this, against the largest step, are one: where a stiffness vanishes
/// with the square of the way, rounding hides its sign on the square root of rounding.
constexpr double kOnePlace = 1e-4;
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
    follow(first, nullptr, 0, -1, 0);
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
    place_held(model_, controls_, positions_);
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
    int lost_directions = 0;
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
    events.push_back({high, after, before.rising() != after.rising(),
                      after.stability.unstable_directions - before.stability.unstable_directions});
    return true;
  }

  /// Makes one of events at one place. Where the stiffness is singular, inertia and sense of the
  /// tangent are made of rounding: they may change several times.
  void merge(std::vector<Located>& events, const Node& start) const {
    std::vector<Located> merged;
    for (Located& located : events) {
      if (merged.empty() || located.step - merged.back().step > kOnePlace * options_.largest_step) {
        merged.push_back(std::move(located));
        continue;
      }
      Located& place = merged.back();
      place.turns = place.turns != located.turns;
      place.lost_directions += located.lost_directions;
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

  /// Follows a branch from `node` on, whose tangent shows the way, and then those that leave it.
  /// `root` is the bifurcation at which it begins, if any.
  void follow(Node node, const Node* root, int depth, int parent, int side) {
    const auto number = branches_.size();
    branches_.emplace_back();
    PathBranch branch;
    branch.parent = parent;
    branch.side = side;
    const Extended origin = root ? root->at : node.at;
    double arc = norm(combine(node.at, -1.0, origin));
    double step = 0.2 * options_.largest_step;
    std::vector<Node> bifurcations;
    if (root) add_point(branch, *root, 0.0, PathEvent::Bifurcation);
    add_point(branch, node, arc, PathEvent::None);
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
      branch.ending = ending;
      merge(events, node);
      for (const Located& located : events) {
        add_point(branch, located.node, arc + located.step, located.event());
        if (located.event() == PathEvent::Bifurcation) bifurcations.push_back(located.node);
      }
      arc += reached;
      add_point(branch, *found, arc, PathEvent::None);
      if (arc > 3.0 * options_.largest_step && passes(origin, node, *found)) {
        branch.ending = "closed loop";
      }
      node = *found;
      if (iterations <= kEasyIterations) step *= 1.5;
      if (iterations >= kHardIterations) step *= 0.7;
      step = std::min(step, options_.largest_step);
    }
    branches_[number] = std::move(branch);
    if (depth >= options_.branching) return;
    for (const Node& bifurcation : bifurcations) {
      for (const int to_side : {1, -1}) switch_branch(bifurcation, depth, number, to_side);
    }
  }

  /// Starts the branch that leaves `bifurcation` to one side of the path it lies on.
  void switch_branch(const Node& bifurcation, int depth, std::size_t parent, int side) {
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
      follow(node, &bifurcation, depth + 1, static_cast<int>(parent), side);
      return;
    }
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
};

}  // namespace

std::vector<PathBranch> follow_path(Model& model, const LoadPath& loads, const Assembler& assembler,
                                    LinearSolver& solver, const ContinuationOptions& options,
                                    const State& start) {
  return Follower(model, loads, assembler, solver, options).run(start);
}

}  // namespace der
