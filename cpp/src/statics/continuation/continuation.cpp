#include "der/statics/continuation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "der/model/followed.hpp"
#include "der/supports/clamp.hpp"
#include "statics/continuation/path_equations.hpp"
#include "statics/continuation/path_events.hpp"
#include "statics/continuation/path_metric.hpp"
#include "statics/continuation/plane_watch.hpp"

namespace der::statics {
namespace {

/// A point found in fewer iterations lets the step grow, in more shrink.
constexpr int kEasyIterations = 4;
constexpr int kHardIterations = 7;
/// The path may turn by this much from point to point [cosine].
constexpr double kLargestBend = 0.9;
/// No clamp turns by more than this from point to point [rad].
constexpr double kLargestTurn = 1.0;
/// A branch ends when the step has shrunk to this fraction of the largest one.
constexpr double kShortestStep = 1e-7;
/// Two bifurcations nearer than this, over the largest step, are one that was met on two paths:
/// where the equations are singular, the residual that Newton's method leaves moves a point by its
/// square root.
constexpr double kSamePlace = 1e-2;
/// Any other point that is nearer than this to a path, over the largest step, lies on it.
constexpr double kSamePath = 1e-5;
/// A path comes back to a place after no less than this many of the largest steps.
constexpr double kShortestLoop = 3.0;
/// A path stays nearer than this to the line between two neighbours, over its length.
constexpr double kBulge = 0.25;
/// The first step of a branch, over the largest.
constexpr double kFirstStep = 0.2;

/// Metric in which a displacement of all nodes by the model's size counts as the whole range.
PathMetric first_metric(const Model& model, double range) {
  return {model.dofs, 1.0 / (model.num_nodes * model.size() * model.size()), range};
}

/// Traces a path of equilibria and the branches that leave it.
class PathTracer {
 public:
  PathTracer(const Model& model, const Assembler& assembler, LinearSolver& solver,
             const ContinuationOptions& options, OutOfPlaneTest* out_of_plane,
             const Vector& positions)
      : model_(model),
        options_(options),
        range_(options.to - options.from),
        largest_clamp_turn_(largest_turn_of_clamps(model, model.load_variation->controls.change)),
        equations_(model, assembler, solver, options, first_metric(model, range_), positions),
        events_(equations_, options.largest_step),
        plane_(equations_, out_of_plane) {}

  TracedPath run(const State& start) {
    PathNode first =
        equations_.node_at(start.followed, {start.positions(model_.dofs.free()), options_.from});
    equations_.set_metric(first);
    if (first.tangent.factor * range_ < 0.0) reverse(first.tangent);
    plane_.look(first);
    trace(first, std::nullopt, 0);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      if (crossings_[i].depth < options_.branching) trace_from(i);
    }
    return {std::move(branches_), equations_.newton_iterations()};
  }

 private:
  [[nodiscard]] const PathMetric& metric() const { return equations_.metric(); }

  void add_point(PathBranch& branch, const PathNode& node, double arc, PathEvent event) const {
    branch.points.push_back({node.at.factor, arc, node.stability, node.out_of_plane, event,
                             node.positions, node.followed});
  }

  /// How far the factor is on its way: 0 at `from`, 1 at `to`.
  [[nodiscard]] double progress(double factor) const { return (factor - options_.from) / range_; }

  /// Whether the path between two neighbours leads past a point.
  [[nodiscard]] bool passes(const PathPosition& point, const PathNode& from,
                            const PathNode& to) const {
    const PathPosition back = difference(point, from.at);
    const PathPosition ahead = difference(point, to.at);
    const double length = metric().distance(to.at, from.at);
    return metric().dot(back, from.tangent) >= 0.0 && metric().dot(ahead, to.tangent) <= 0.0 &&
           std::max(metric().norm(back), metric().norm(ahead)) < 1.5 * length;
  }

  /// Whether a point `step` ahead may be the next one: the path bends little up to it, and nothing
  /// turns so far that whole turns could be lost.
  [[nodiscard]] bool is_near(const PathNode& node, double step, const PathNode& found) const {
    const double turn = largest_clamp_turn_ * std::abs(found.at.factor - node.at.factor);
    const Vector controls = model_.load_variation->controls.at(found.at.factor);
    return turn <= kLargestTurn &&
           turned_too_far(model_, found.positions, controls, node.followed) < 0 &&
           metric().dot(found.tangent, node.tangent) >= kLargestBend &&
           step >= kLargestBend * metric().distance(found.at, node.at);
  }

  /// If the factor passes `to`, or the opposite limit, on the way to `found`, moves `found` there,
  /// which is `reached` ahead; it is lost if no equilibrium is found there. Returns the ending of
  /// the branch, empty if no limit was passed.
  std::string stop_at_limits(const PathNode& node, std::optional<PathNode>& found,
                             double& reached) {
    const double before = progress(node.at.factor);
    const double now = progress(found->at.factor);
    for (const double limit : {1.0, -1.0}) {
      if ((before - limit) * (now - limit) >= 0.0 || before == limit) continue;
      const double share = (limit - before) / (now - before);
      found = equations_.node_at_factor(node, options_.from + limit * range_,
                                        combine(node.at, share, difference(found->at, node.at)));
      if (found) reached = metric().dot(node.tangent, difference(found->at, node.at));
      return limit > 0.0 ? "last factor" : "reached the opposite limit";
    }
    return "";
  }

  /// A bifurcation, and the branch on which it was met first.
  struct Crossing {
    PathNode node;
    int branch = 0;
    double arc = 0.0;              // on that branch
    int depth = 0;                 // bifurcations between that branch and the first one
    bool traced = false;           // whether its branches have been
    std::vector<PathNode> beyond;  // points behind it, of branches that end here
  };

  /// Number of the bifurcation at a place `arc` along a branch, if it is known.
  std::optional<std::size_t> crossing_at(const LocatedEvent& place, int branch, double arc) {
    const double same = kSamePlace * options_.largest_step + 2.0 * place.reach;
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      const Crossing& known = crossings_[i];
      const bool came_back =
          known.branch != branch || arc - known.arc > kShortestLoop * options_.largest_step;
      if (came_back && distance(known.node, place.node) < same) return i;
    }
    return std::nullopt;
  }

  /// The distance of two nodes that were reached on different ways.
  double distance(const PathNode& a, const PathNode& b) {
    return metric().distance(in_chart_of(b.followed, a), b.at);
  }

  PathPosition in_chart_of(const Vector& chart, const PathNode& node) {
    return equations_.in_chart(chart, node.at.factor, node.positions, node.followed);
  }
  PathPosition in_chart_of(const Vector& chart, const PathPoint& point) {
    return equations_.in_chart(chart, point.factor, point.positions, point.followed);
  }

  /// Whether a node lies on a branch that is over: whether Newton leads to it from the line that
  /// joins two neighbours, on the plane across that line. Neither of them need be near.
  bool is_traced(const PathNode& node) {
    for (const PathBranch& branch : branches_) {
      for (std::size_t i = 0; i + 1 < branch.points.size(); ++i) {
        if (lies_between(branch.points[i], branch.points[i + 1], node)) return true;
      }
    }
    return false;
  }

  bool lies_between(const PathPoint& first, const PathPoint& second, const PathNode& node) {
    const PathPosition from = in_chart_of(first.followed, first);
    const PathPosition to = in_chart_of(first.followed, second);
    const PathPosition point = in_chart_of(first.followed, node);
    const PathPosition line = difference(to, from);
    const double length = metric().norm(line);
    const double same = kSamePath * options_.largest_step;
    if (length < same) return false;
    const PathPosition direction = metric().unit(line);
    const double along = metric().dot(difference(point, from), direction);
    if (along < -same || along > length + same) return false;
    const PathPosition foot = combine(from, along, direction);
    if (metric().distance(point, foot) > kBulge * length) return false;
    int iterations = 0;
    const auto found =
        equations_.solve_on_plane(first.followed, from, direction, along, foot, iterations);
    return found && metric().distance(point, *found) < same;
  }

  /// A branch while it is traced.
  struct Trace {
    PathBranch branch;
    int number = 0;
    std::optional<std::size_t> root;  // the bifurcation at which it begins
    int depth = 0;                    // bifurcations between it and the first branch
    PathNode origin;
    double arc = 0.0;
  };

  /// A branch whose first point besides its root, if it has one, is `first`.
  Trace begin_trace(const PathNode& first, std::optional<std::size_t> root, int side) {
    Trace trace;
    trace.number = static_cast<int>(branches_.size());
    trace.root = root;
    trace.branch.side = side;
    trace.origin = first;
    if (root) {
      const Crossing& start = crossings_[*root];
      trace.branch.parent = start.branch;
      trace.origin = start.node;
      trace.depth = start.depth + 1;
      add_point(trace.branch, start.node, 0.0, PathEvent::None);
    }
    trace.arc = distance(trace.origin, first);
    add_point(trace.branch, first, trace.arc, PathEvent::None);
    return trace;
  }

  /// Whether a branch that meets a known bifurcation on its way to `found` ends there: what lies
  /// beyond has been traced, or will be from there.
  bool ends_at(Crossing& crossing, const Trace& trace, const PathNode& found) {
    if (crossing.branch == trace.number) return false;
    int iterations = 0;
    const auto beyond = equations_.next(found, kFirstStep * options_.largest_step, iterations);
    if (!beyond) return false;
    if (crossing.depth < options_.branching && !crossing.traced) {
      crossing.beyond.push_back(*beyond);
      return true;
    }
    return is_traced(*beyond);
  }

  /// Puts the events on the way to `found` into a branch, each the first time that it is met. Ends
  /// the branch where it goes over into what has been traced.
  void add_events(const std::vector<LocatedEvent>& events, const PathNode& found, Trace& trace) {
    for (const LocatedEvent& located : events) {
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

  /// Whether rounding hides the stability at a node, or beside an event on the way to it.
  [[nodiscard]] static bool is_hidden(const PathNode& node,
                                      const std::vector<LocatedEvent>& events) {
    return node.stability.unknown_directions > 0 ||
           std::any_of(events.begin(), events.end(), [](const LocatedEvent& event) {
             return event.node.stability.unknown_directions > 0;
           });
  }

  /// Traces a branch from `node` on, along its tangent. `root` is the number of the
  /// bifurcation at which it begins, if any.
  void trace(PathNode node, std::optional<std::size_t> root, int side) {
    Trace now = begin_trace(node, root, side);
    PathBranch& branch = now.branch;
    double step = kFirstStep * options_.largest_step;
    while (branch.ending.empty()) {
      if (static_cast<int>(branch.points.size()) >= options_.max_points) {
        branch.ending = "largest number of points";
        break;
      }
      int iterations = 0;
      auto found = equations_.next(node, step, iterations);
      double reached = step;
      std::string ending;
      std::vector<LocatedEvent> events;
      if (found && is_near(node, step, *found)) ending = stop_at_limits(node, found, reached);
      if (!found || !is_near(node, reached, *found) ||
          !events_.locate(node, reached, *found, events)) {
        step *= 0.5;
        if (step < kShortestStep * options_.largest_step) branch.ending = "no further point found";
        continue;
      }
      if (is_hidden(*found, events)) {
        branch.ending = "rounding hides the stability";
        break;
      }
      events_.merge(events, node);
      for (LocatedEvent& event : events) plane_.look(event.node);
      plane_.look(*found);
      plane_.locate(node, reached, *found, events);
      add_events(events, *found, now);
      if (!branch.ending.empty()) break;
      branch.ending = ending;
      now.arc += reached;
      add_point(branch, *found, now.arc, PathEvent::None);
      if (now.arc > kShortestLoop * options_.largest_step &&
          passes(in_chart_of(node.followed, now.origin), node, *found)) {
        branch.ending = "closed loop";
      }
      node = *found;
      if (iterations <= kEasyIterations) step *= 1.5;
      if (iterations >= kHardIterations) step *= 0.7;
      step = std::min(step, options_.largest_step);
    }
    branches_.push_back(std::move(branch));
  }

  /// Traces all branches that leave a bifurcation and have not been traced: to both sides of the
  /// path it lies on, and on from those that end there.
  void trace_from(std::size_t number) {
    const auto trace_new = [&](const PathNode& node, int side) {
      if (!is_traced(node)) trace(node, number, side);
    };
    for (const int side : {1, -1}) {
      if (const auto node = first_point(crossings_[number].node, side)) trace_new(*node, side);
    }
    // Tracing may add to both lists. NOLINTNEXTLINE(modernize-loop-convert)
    for (std::size_t i = 0; i < crossings_[number].beyond.size(); ++i) {
      trace_new(PathNode(crossings_[number].beyond[i]), 0);
    }
    crossings_[number].traced = true;
  }

  /// The first point of the branch that leaves `bifurcation` to one side of the path it lies on.
  std::optional<PathNode> first_point(const PathNode& bifurcation, int side) {
    PathPosition across = equations_.null_direction(bifurcation);
    across = combine(across, -metric().dot(across, bifurcation.tangent), bifurcation.tangent);
    across = metric().unit(across);
    if (side < 0) reverse(across);
    for (double step = 0.5 * options_.largest_step; step > 1e-4 * options_.largest_step;
         step *= 0.5) {
      int iterations = 0;
      const auto found =
          equations_.solve_on_plane(bifurcation.followed, bifurcation.at, across, step,
                                    combine(bifurcation.at, step, across), iterations);
      if (!found) continue;
      PathNode node = equations_.node_at(bifurcation.followed, *found);
      const PathPosition way = difference(node.at, bifurcation.at);
      if (metric().dot(node.tangent, way) < 0.0) reverse(node.tangent);
      plane_.look(node);
      return node;
    }
    return std::nullopt;
  }

  const Model& model_;
  const ContinuationOptions& options_;
  double range_;
  double largest_clamp_turn_;  // by a unit of the factor [rad]
  PathEquations equations_;
  EventLocator events_;
  PlaneMonitor plane_;
  std::vector<PathBranch> branches_;
  std::vector<Crossing> crossings_;
};

}  // namespace
}  // namespace der::statics

namespace der {

TracedPath follow_path(const Model& model, const Assembler& assembler, LinearSolver& solver,
                       const ContinuationOptions& options, OutOfPlaneTest* out_of_plane,
                       const State& start) {
  return statics::PathTracer(model, assembler, solver, options, out_of_plane, start.positions)
      .run(start);
}

}  // namespace der
