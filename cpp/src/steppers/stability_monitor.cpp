#include "der/steppers/stability_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "der/core/error.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/dimension.hpp"
#include "der/scenario/time.hpp"

namespace der {
namespace {

/// Change of an edge, over its length or as an angle [rad], beyond which the stable step is
/// evaluated again.
constexpr double kOtherShape = 0.03;
/// No step of `step: auto` changes an edge's length, or an angle [rad], by more than this.
constexpr double kLargestChange = 0.03;
/// The fraction of the stable step that pieces of a step take. Pieces are needed where the motion
/// is as fast as the fastest vibration of the rod. Steps near the stable one do not resolve it: the
/// error of its energy is as large as the energy.
constexpr double kPieceMargin = 0.45;
/// Pieces get shorter when this share is exceeded: less than the margin of a whole step.
constexpr double kLeastMargin = 0.6;
/// The run fails if pieces become shorter than this fraction of a step, unless the scene sets
/// another limit.
constexpr double kLeastPiece = 1e-5;
/// A step longer than the stable one by no more than this share is the stable one.
constexpr double kStepRounding = 1e-9;

constexpr const char* kAdvice =
    "Write 'step: auto', which follows the limit, or a step of at most {:.2g} s, take an implicit "
    "integrator, or say 'allow_unstable: true' to run it all the same";

/// Whether the step may be above the stable one. Those of `step: auto` and of a tolerance never
/// are.
bool may_be_unstable(const scenario::Time& time) {
  return time.allow_unstable && time.stepping == scenario::Stepping::Fixed;
}

/// Rate of change of the shape [1/s]: the largest strain rate of an edge, or rate of the angle
/// between an edge and the one before it in its rod.
double planar_rate_of_change(const Model& model, const State& state) {
  double largest = 0.0;
  double turn_before = 0.0;
  for (std::size_t i = 0; i < model.edges.size(); ++i) {
    const Vec2 edge = along_edge(model.edges[i], state.positions);
    const Vec2 rate = along_edge(model.edges[i], state.velocities);
    const double per_squared = 1.0 / edge.squaredNorm();
    const double turn = cross(edge, rate) * per_squared;
    largest = std::max(largest, std::abs(edge.dot(rate) * per_squared));
    const bool joined = i > 0 && model.edges[i - 1].last == model.edges[i].first;
    if (joined) largest = std::max(largest, std::abs(turn - turn_before));
    turn_before = turn;
  }
  return largest;
}

/// The same in space, twisting included: the rates of change of directions are vectors.
double spatial_rate_of_change(const Model& model, const State& state) {
  double largest = 0.0;
  Vec3 turn_before = Vec3::Zero();
  for (std::size_t i = 0; i < model.edges.size(); ++i) {
    const Vec3 edge = along_edge<3>(model.edges[i], state.positions);
    const Vec3 rate = along_edge<3>(model.edges[i], state.velocities);
    const double per_squared = 1.0 / edge.squaredNorm();
    Vec3 turn = per_squared * edge.cross(rate);
    if (!model.framed_edges.empty()) {
      turn += state.velocities[model.framed_edges[i].theta] * std::sqrt(per_squared) * edge;
    }
    largest = std::max(largest, std::abs(edge.dot(rate) * per_squared));
    const bool joined = i > 0 && model.edges[i - 1].last == model.edges[i].first;
    if (joined) largest = std::max(largest, (turn - turn_before).norm());
    turn_before = turn;
  }
  return largest;
}

double rate_of_change(const Model& model, const State& state) {
  return model.dimension == 2 ? planar_rate_of_change(model, state)
                              : spatial_rate_of_change(model, state);
}

/// Whether an edge has changed since the positions `before`; rigid translation does not count.
bool has_other_shape(const Model& model, const Vector& positions, const Vector& before) {
  return with_dimension(model, [&](auto dim) {
    return std::any_of(model.edges.begin(), model.edges.end(), [&](const Edge& edge) {
      const auto then = along_edge<dim>(edge, before);
      const auto now = along_edge<dim>(edge, positions);
      return (now - then).squaredNorm() > kOtherShape * kOtherShape * then.squaredNorm();
    });
  });
}

}  // namespace

StabilityMonitor::StabilityMonitor(const Model& model, const StepperInfo& stepper,
                                   const scenario::Time& time)
    : model_(model),
      time_(time),
      bound_(model, stepper.drag_limits_step),
      here_{Vector::Zero(model.num_dofs()), Vector::Zero(model.tables.size())} {}

double StabilityMonitor::stable_step(const State& state) {
  configuration_of(model_, state, here_);
  return bound_.evaluate(here_);
}

StableStep StabilityMonitor::explain(const State& state) {
  configuration_of(model_, state, here_);
  return bound_.explain(here_);
}

void StabilityMonitor::check_start(const State& state) {
  if (time_.stepping == scenario::Stepping::Adaptive || may_be_unstable(time_)) return;
  const bool automatic = time_.stepping == scenario::Stepping::Automatic;
  const double limit = stable_step(state);
  if (automatic && kStepMargin * limit < time_.minimum_step) {
    throw Error("unstable_step",
                fmt::format("time.minimum_step of {:g} s leaves no stable step: {}. Lower it, or "
                            "take an implicit integrator",
                            time_.minimum_step,
                            describe_stable_step(explain(state), time_.integrator, model_)));
  }
  if (automatic || time_.step <= limit * (1.0 + kStepRounding)) return;
  const StableStep stable = explain(state);
  throw Error("unstable_step", fmt::format("time.step of {:g} s is above {}. ", time_.step,
                                           describe_stable_step(stable, time_.integrator, model_)) +
                                   fmt::format(kAdvice, kStepMargin * stable.step));
}

void StabilityMonitor::look(State& state, double step) {
  if (may_be_unstable(time_)) return;
  const auto* last = std::get_if<StabilityMemory>(&state.memory);
  const bool looked = last != nullptr;
  if (looked && !has_other_shape(model_, state.positions, last->positions)) return;
  // A program may have written these; the stepper reports where.
  if (!state.positions.allFinite()) return;
  hold<StabilityMemory>(state.memory).positions = state.positions;

  const double stable = stable_step(state);
  if (time_.stepping == scenario::Stepping::Fixed) {
    if (!(step <= stable * (1.0 + kStepRounding))) throw DivergedError(explain_overrun(state));
    state.next_step = step;
    return;
  }
  const double longest = std::min(stable, kLargestChange / rate_of_change(model_, state));
  const auto bears = [&](double length, double margin) {
    return length <= margin * longest * (1.0 + kStepRounding);
  };
  const bool whole = bears(step, kStepMargin);
  const double least = time_.minimum_step > 0.0 ? time_.minimum_step : kLeastPiece * step;
  if (!whole && !(kPieceMargin * stable >= least)) throw DivergedError(explain_end(state, least));
  const double fewest = whole ? 1.0 : std::ceil(step / (kPieceMargin * longest));
  const double pieces = looked ? std::round(step / state.next_step) : 1.0;
  const bool is_stable = pieces == 1.0 ? whole : bears(state.next_step, kLeastMargin);
  // Fewer pieces are taken as soon as they suffice, more of them only if the present ones are no
  // longer stable: frequent changes of the step spoil the energy conservation of Verlet's scheme.
  if (looked && is_stable && fewest >= pieces) return;
  state.next_step = step / fewest;
}

std::string StabilityMonitor::explain_overrun(const State& state) {
  const StableStep stable = explain(state);
  return fmt::format(
             "the motion would diverge from t = {:.6g} s on: the rod has become stiffer, "
             "and time.step of {:g} s is above {} now. ",
             state.time, time_.step, describe_stable_step(stable, time_.integrator, model_)) +
         fmt::format(kAdvice, kStepMargin * stable.step);
}

std::string StabilityMonitor::explain_end(const State& state, double least) {
  return fmt::format(
      "the motion cannot go on from t = {:.6g} s: {} now, too close to time.minimum_step of {:.3g} "
      "s. Edges that are crushed or folded flat do that: take an implicit integrator, or fewer "
      "nodes",
      state.time, describe_stable_step(explain(state), time_.integrator, model_), least);
}

std::string StabilityMonitor::explain_blow_up(const State& start, const State& last, double step) {
  const StableStep stable = explain(may_be_unstable(time_) ? start : last);
  const std::string limit = describe_stable_step(stable, time_.integrator, model_);
  if (step <= stable.step) {
    return fmt::format(
        "The step of {:.3g} s is below {}{}: the motion itself is faster than that. Take an "
        "implicit integrator, or fewer nodes.",
        step, limit, may_be_unstable(time_) ? " at the start" : " there");
  }
  return fmt::format(
      "The step of {:.3g} s is above {}. Use time.step <= {:.2g}, or an implicit "
      "integrator.",
      step, limit, kStepMargin * stable.step);
}

}  // namespace der
