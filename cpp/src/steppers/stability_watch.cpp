#include "der/steppers/stability_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "der/core/error.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {
namespace {

/// Steps between two looks, each of which costs about as much as a step, and steps, or pieces of
/// them, between two of a rod whose shape changes fast.
constexpr std::int64_t kStepsBetweenLooks = 32;
constexpr std::int64_t kPiecesBetweenLooks = 4;
/// Change of an edge's length, or of an angle [rad], that makes another shape, with a stable step
/// of its own: fast is as much until the next look, and no step of `step: auto` changes more.
constexpr double kOtherShape = 0.1;
/// A step longer than the stable one by no more than this share is the stable one.
constexpr double kRounding = 1e-9;

constexpr const char* kAdvice =
    "Write 'step: auto', which follows the limit, or a step of at most {:.2g} s, take an implicit "
    "integrator, or say 'allow_unstable: true' to run it all the same";

/// How fast the shape changes [1/s]: the largest rate of stretch of an edge, or of turn of one edge
/// against the one before.
double rate_of_change(const Model& model, const State& state) {
  double largest = 0.0;
  double turn_before = 0.0;
  for (std::size_t i = 0; i < model.edges.size(); ++i) {
    const auto& [x0, y0, x1, y1] = model.edges[i].dofs;
    const auto between = [](const Vector& v, Index a, Index b) { return v[b] - v[a]; };
    const Vec2 edge{between(state.positions, x0, x1), between(state.positions, y0, y1)};
    const Vec2 rate{between(state.velocities, x0, x1), between(state.velocities, y0, y1)};
    const double per_squared = 1.0 / edge.squaredNorm();
    const double turn = cross(edge, rate) * per_squared;
    largest = std::max(largest, std::abs(edge.dot(rate) * per_squared));
    if (i > 0) largest = std::max(largest, std::abs(turn - turn_before));
    turn_before = turn;
  }
  return largest;
}

}  // namespace

StabilityWatch::StabilityWatch(const Model& model, const StepperInfo& stepper,
                               const scenario::Time& time)
    : model_(model),
      stepper_(stepper),
      time_(time),
      bound_(model, stepper.drag_limits_step),
      controls_(Vector::Zero(model.controls.size())) {}

double StabilityWatch::stable_step(const State& state) {
  model_.controls.evaluate(state.time, state.ramps, controls_);
  return bound_.evaluate(state.positions, controls_);
}

StableStep StabilityWatch::explain(const State& state) {
  model_.controls.evaluate(state.time, state.ramps, controls_);
  return bound_.explain(state.positions, controls_);
}

void StabilityWatch::check_start(const State& state) {
  if (time_.stepping != scenario::Stepping::Fixed || time_.allow_unstable) return;
  if (time_.step <= stable_step(state) * (1.0 + kRounding)) return;
  const StableStep stable = explain(state);
  throw Error("unstable_step", fmt::format("time.step of {:g} s is above {}. ", time_.step,
                                           describe_stable_step(stable, time_.integrator, model_)) +
                                   fmt::format(kAdvice, kStepMargin * stable.step));
}

void StabilityWatch::look(State& state, double step) {
  if (time_.allow_unstable) return;
  const bool looked = state.next_step > 0.0;
  const std::int64_t pieces = looked ? std::llround(step / state.next_step) : 1;
  if (looked && state.step % std::max<std::int64_t>(1, kPiecesBetweenLooks / pieces) != 0) return;
  const double rate = rate_of_change(model_, state);
  const bool fast =
      pieces > 1 || rate * step * static_cast<double>(kStepsBetweenLooks) > kOtherShape;
  if (looked && !fast && state.step % kStepsBetweenLooks != 0) return;
  // What a program may have written there; the stepper says where.
  if (!state.positions.allFinite()) return;

  const double stable = stable_step(state);
  if (time_.stepping == scenario::Stepping::Fixed) {
    if (!(step <= stable * (1.0 + kRounding))) throw DivergedError(explain_overrun(state));
    state.next_step = step;
    return;
  }
  if (!(kStepMargin * stable >= time_.minimum_step)) throw DivergedError(explain_end(state));
  const double longest = std::min(stable, kOtherShape / rate);
  // A longer piece may do later on; a shorter one is taken only when it must be, since steps that
  // change all the time cost Verlet's scheme its grip on the energy.
  const double fewest =
      std::max(1.0, std::ceil(step / (kStepMargin * longest) * (1.0 - kRounding)));
  if (looked && state.next_step <= longest && fewest >= static_cast<double>(pieces)) return;
  state.next_step = step / fewest;
}

std::string StabilityWatch::explain_overrun(const State& state) {
  const StableStep stable = explain(state);
  return fmt::format(
             "the motion would diverge from t = {:.6g} s on: the rod has become stiffer, "
             "and time.step of {:g} s is above {} now. ",
             state.time, time_.step, describe_stable_step(stable, time_.integrator, model_)) +
         fmt::format(kAdvice, kStepMargin * stable.step);
}

std::string StabilityWatch::explain_end(const State& state) {
  return fmt::format(
      "the motion cannot go on from t = {:.6g} s: {} now, too close to time.minimum_step of {:.3g} "
      "s. Edges that are crushed or folded flat do that: take an implicit integrator, or fewer "
      "nodes",
      state.time, describe_stable_step(explain(state), time_.integrator, model_),
      time_.minimum_step);
}

std::string StabilityWatch::explain_blow_up(const State& start, double step) {
  const StableStep stable = explain(start);
  const std::string limit = describe_stable_step(stable, time_.integrator, model_);
  if (step <= stable.step) {
    return fmt::format(
        "The step of {:.3g} s is below {} at the start: the motion itself stiffens the rod. Try "
        "'step: auto', or an implicit integrator.",
        step, limit);
  }
  return fmt::format(
      "The step of {:.3g} s is above {}. Use time.step <= {:.2g}, or an implicit "
      "integrator.",
      step, limit, kStepMargin * stable.step);
}

}  // namespace der
