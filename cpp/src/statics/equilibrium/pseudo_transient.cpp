#include "statics/equilibrium/pseudo_transient.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/statics/potential.hpp"

namespace der::statics {
namespace {

constexpr int kMaxSteps = 500;
/// A step that changes an edge by more than this [rad] may lead into the basin of another
/// equilibrium.
constexpr double kLargestEdgeChange = 2.0;
/// A run ends when the inverse pseudo-time step exceeds this multiple of its first value or of the
/// acting force over the model's size.
constexpr double kLargestInverseStep = 1e12;
/// Factor of the inverse pseudo-time step after a failed step.
constexpr double kBackOff = 4.0;
/// A plain Newton step is tried once the steps change no edge by more than this [rad], and, if it
/// fails, again when they have shrunk by the factor.
constexpr double kTryNewton = 0.3;
constexpr double kTryNewtonAgain = 0.3;

/// Why a run that reached no equilibrium failed. The last failure of a step says most, unless the
/// rod is folded.
FailedSearch diagnose(const Model& model, const Shape& shape, std::optional<FailedSearch> failed) {
  if (!failed) failed = FailedSearch{EquilibriumFailure::StepsUsedUp, {}};
  const bool unspecific = failed->cause == EquilibriumFailure::NewtonFailed ||
                          failed->cause == EquilibriumFailure::StepsUsedUp;
  if (unspecific && is_folded(model, shape.positions)) {
    return {EquilibriumFailure::FoldedByLoad, {}};
  }
  return *std::move(failed);
}

}  // namespace

PseudoTransient::PseudoTransient(const Model& model, StaticNewton& newton)
    : model_(model), newton_(newton), turning_(model) {}

PseudoTransient::Result PseudoTransient::run(const StaticLoads& loads, double inverse_step,
                                             Shape& shape, double decay) {
  const double largest =
      kLargestInverseStep * std::max(inverse_step, newton_.force_scale() / model_.size());
  turning_.reset();
  double change_for_newton = kTryNewton;
  Result result;
  std::optional<FailedSearch> failed;
  for (int i = 0; i < kMaxSteps && inverse_step <= largest; ++i) {
    ++steps_;
    std::optional<Step> step = try_step(loads, shape, inverse_step, failed);
    if (!step) {
      inverse_step *= kBackOff;
      decay = std::sqrt(decay);
      continue;
    }
    const double change = largest_edge_change(model_, step->positions - shape.positions);
    turning_.add(shape.positions, step->positions);
    if (turning_.is_unbounded(loads.controls)) {
      result.failed = FailedSearch{EquilibriumFailure::TurnsWithoutEnd, {}};
      return result;
    }
    shape.positions = std::move(step->positions);
    loads.follow(model_, shape);
    result.energy_change += step->energy_change;
    if (change < change_for_newton) {
      StaticNewton::LastStep last = newton_.balance_nearby(loads, shape);
      if (last.reached) {
        result.energy_change += last.energy_change;
        return result;
      }
      if (last.failed) failed = std::move(last.failed);
      change_for_newton *= kTryNewtonAgain;
    }
    if (change < 1.0) inverse_step *= change < 0.1 ? decay * decay : decay;
    decay = std::max(kDecay, 0.9 * decay);
  }
  result.failed = diagnose(model_, shape, std::move(failed));
  return result;
}

/// Nothing if the step fails, leads uphill or is too long; `failed` is set in the first case. The
/// second attempt, with a line search, is slower but stays in the basin more often.
std::optional<PseudoTransient::Step> PseudoTransient::try_step(
    const StaticLoads& loads, const Shape& shape, double inverse_step,
    std::optional<FailedSearch>& failed) {
  using LineSearch = StaticNewton::LineSearch;
  Stage stage = newton_.stage_of(loads);
  stage.inertia = inverse_step;
  stage.inertia_target = shape.positions;
  for (const LineSearch line_search : {LineSearch::IfNeeded, LineSearch::Always}) {
    Configuration here = loads.at(model_, shape);
    if (auto why = newton_.solve(stage, here, line_search)) {
      failed = std::move(why);
      continue;
    }
    Step step{std::move(here.coordinates), 0.0};
    if (largest_edge_change(model_, step.positions - shape.positions) > kLargestEdgeChange ||
        turned_too_far(model_, step.positions, loads.controls, shape.followed) >= 0) {
      continue;
    }
    step.energy_change = energy_change(model_, loads, shape, shape.positions, step.positions);
    if (step.energy_change <= newton_.energy_resolution()) return step;
  }
  return std::nullopt;
}

}  // namespace der::statics
