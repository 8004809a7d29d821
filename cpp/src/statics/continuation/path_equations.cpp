#include "statics/continuation/path_equations.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/core/index.hpp"
#include "der/kinematics/section_frame.hpp"
#include "der/loads/external_force.hpp"
#include "der/model/followed.hpp"
#include "der/model/frames.hpp"
#include "der/model/prescribed_motion.hpp"

namespace der::statics {
namespace {

/// Newton iterations of one point; more mean that the step is too long.
constexpr int kMaxIterations = 12;
/// The last Newton step of a point, in arc length. Convergence is quadratic: the next one would be
/// its square.
constexpr double kLastStep = 1e-7;

/// The frames in a vector `followed` of the model.
Vector model_frames(const Model& model, const Vector& followed) {
  return followed.tail(model.initial_frames.size());
}

/// Angle [rad] about an edge by which its director in the frames `to` is turned against that of
/// `from`, transported to the same tangent.
double director_angle(Index edge, const Vector& from, const Vector& to) {
  return twist_between(reference_frame(edge, from), reference_frame(edge, to));
}

}  // namespace

PathEquations::PathEquations(const Model& model, const Assembler& assembler, LinearSolver& solver,
                             const ContinuationOptions& options, PathMetric metric,
                             Vector positions)
    : model_(model),
      loads_(*model.load_variation),
      assembler_(assembler),
      options_(options.newton),
      metric_(std::move(metric)),
      stiffness_(model, assembler, solver, options.beat),
      tension_(model, assembler),
      here_{std::move(positions), {}},
      no_extra_(Vector::Zero(model.num_dofs())) {}

void PathEquations::set_metric(PathNode& first) {
  metric_.balance(first.tangent);
  first.tangent = metric_.unit(first.tangent);
}

/// Sets the full positions, held degrees of freedom where the factor has them, and the controls.
void PathEquations::place(const Vector& followed, const PathPosition& point) {
  here_.load_factor = point.factor;
  here_.controls = loads_.controls.at(point.factor);
  enter_followed(model_, followed, here_.controls);
  apply_prescribed_motion(model_, here_.controls, here_.coordinates);
  here_.coordinates(model_.dofs.free()) = point.x;
}

/// Sets the residual and the stiffness at a point.
void PathEquations::evaluate(const Vector& followed, const PathPosition& point) {
  place(followed, point);
  external_force(model_, here_, no_extra_, force_);
  stiffness_.evaluate(here_);
  residual_ = (stiffness_.gradient() - force_)(model_.dofs.free());
  force_scale_ =
      std::max(model_.dofs.largest_force(stiffness_.gradient()), model_.dofs.largest_force(force_));
}

double PathEquations::unbalanced() const {
  return model_.dofs.largest_free_force(stiffness_.gradient() - force_);
}

Vector PathEquations::residual_at(const Vector& followed, const PathPosition& point) {
  place(followed, point);
  external_force(model_, here_, no_extra_, force_);
  Vector gradient(model_.num_dofs());
  assembler_.gradient(here_, gradient);
  return (gradient - force_)(model_.dofs.free());
}

/// Derivative of the residual with respect to the factor, by central differences. Forces and
/// moments are linear in it, so that a long step is exact; a moving support needs a short one.
Vector PathEquations::factor_derivative(const Vector& followed, const PathPosition& point) {
  const double step = (loads_.is_linear ? 1.0 : 1e-6) * std::abs(metric_.range());
  PathPosition forward = point;
  PathPosition backward = point;
  forward.factor += step;
  backward.factor -= step;
  return (residual_at(followed, forward) - residual_at(followed, backward)) / (2.0 * step);
}

/// Unit tangent of the path at a point just evaluated, factor rising. The stability is that of the
/// stiffness itself, without a margin for rounding, which would move the events.
PathPosition PathEquations::tangent(const Vector& followed, const PathPosition& point,
                                    Stability& stability) {
  const Vector derivative = factor_derivative(followed, point);
  if (!by_pivots_) by_pivots_ = stiffness_.is_clear();
  std::optional<Stability> judged;
  if (!*by_pivots_) judged = stiffness_.stability();
  stability = judged.value_or(stiffness_.stability_by_pivots());  // factorises K for the tangent
  PathPosition result{-derivative, 1.0};
  stiffness_.solve(result.x);
  return metric_.unit(result);
}

PathNode PathEquations::node_at(const Vector& followed, const PathPosition& point) {
  place(followed, point);
  PathNode node;
  node.at = point;
  node.positions = here_.coordinates;
  node.followed = followed;
  follow(model_, here_.coordinates, here_.controls, node.followed);
  // A tangent belongs to the chart of its node: frames have moved there, and the change of an
  // angle counts from them.
  const Vector& chart = model_.has_sections() ? node.followed : followed;
  evaluate(chart, point);
  node.tangent = tangent(chart, point, node.stability);
  return node;
}

PathPosition PathEquations::in_chart(const Vector& chart, double factor, const Vector& positions,
                                     const Vector& followed) {
  PathPosition point{positions(model_.dofs.free()), factor};
  if (!model_.has_sections()) return point;
  const Vector own = model_frames(model_, followed);
  const Vector other = model_frames(model_, chart);
  for (Index edge = 0; edge < static_cast<Index>(model_.framed_edges.size()); ++edge) {
    const Index free = model_.dofs.free_index(model_.framed_edges[to_size(edge)].theta);
    if (free >= 0) point.x[free] += director_angle(edge, other, own);
  }
  return point;
}

const Configuration& PathEquations::configuration_at(const PathNode& node) {
  place(node.followed, node.at);
  return here_;
}

std::optional<PathPosition> PathEquations::solve_on_plane(const Vector& followed,
                                                          const PathPosition& base,
                                                          const PathPosition& normal, double step,
                                                          PathPosition guess, int& iterations) {
  evaluate(followed, guess);
  for (iterations = 1; iterations <= kMaxIterations; ++iterations) {
    ++newton_iterations_;
    const Vector derivative = factor_derivative(followed, guess);
    place(followed, guess);
    if (!stiffness_.factorize().factorised) return std::nullopt;
    Vector along = -residual_;
    Vector across = -derivative;
    stiffness_.solve(along);
    stiffness_.solve(across);
    const double miss = metric_.dot(normal, difference(guess, base)) - step;
    const double range2 = metric_.range() * metric_.range();
    const double slope = metric_.dot(normal.x, across) + normal.factor / range2;
    PathPosition change;
    change.factor = (-miss - metric_.dot(normal.x, along)) / slope;
    change.x = along + change.factor * across;
    const double length = metric_.norm(change);
    if (!std::isfinite(length) || length > 10.0 * std::max(step, 1e-3)) return std::nullopt;
    guess = combine(guess, 1.0, change);
    evaluate(followed, guess);
    const double allowed =
        std::max(options_.residual_tolerance * force_scale_, stiffness_.rounding() * model_.size());
    if (length < kLastStep && unbalanced() <= allowed) return guess;
    tension_.use(here_, over_all_dofs(model_, change.x), 1.0, stiffness_.values());
  }
  return std::nullopt;
}

std::optional<PathNode> PathEquations::next(const PathNode& from, double step, int& iterations) {
  const auto found = solve_on_plane(from.followed, from.at, from.tangent, step,
                                    combine(from.at, step, from.tangent), iterations);
  if (!found) return std::nullopt;
  PathNode node = node_at(from.followed, *found);
  if (metric_.dot(node.tangent, from.tangent) < 0.0) reverse(node.tangent);
  return node;
}

std::optional<PathNode> PathEquations::node_at_factor(const PathNode& near, double factor,
                                                      PathPosition guess) {
  const double range = std::abs(metric_.range());
  const PathPosition normal{Vector::Zero(model_.num_free()), range};
  const PathPosition base{near.at.x, 0.0};
  guess.factor = factor;
  int iterations = 0;
  const auto found =
      solve_on_plane(near.followed, base, normal, factor / range, std::move(guess), iterations);
  if (!found) return std::nullopt;
  PathNode node = node_at(near.followed, *found);
  if (metric_.dot(node.tangent, near.tangent) < 0.0) reverse(node.tangent);
  return node;
}

bool PathEquations::is_singular(const PathNode& start, double step) {
  int iterations = 0;
  if (!next(start, step, iterations)) return true;
  const double rounding = stiffness_.rounding();
  return stiffness_.factorize(rounding).negative_pivots !=
         stiffness_.factorize(-rounding).negative_pivots;
}

PathPosition PathEquations::null_direction(const PathNode& node) {
  evaluate(node.followed, node.at);
  return {stiffness_.nearest_to_zero().direction, 0.0};
}

}  // namespace der::statics
