// Why a step failed or is not to be trusted, and what to try.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"

namespace der {

std::string Simulation::describe_failure(const StepReport& report, double dt) const {
  return fmt::format(
      "a step from t = {:.6g} s failed even with a length of {:.3g} s: {}; the worst residual is "
      "at {}. A load that rises too fast, a shape that snaps, or too tight a "
      "solver.residual_tolerance are the usual causes; a smaller time.{} or smoother load tables "
      "help.",
      state_.time, dt, report.failure, describe_dof(model_, report.worst_dof),
      adaptive_ ? "minimum_step" : "step");
}

std::string Simulation::describe_inaccuracy(const AdaptiveReport& report) const {
  const scenario::Time& time = scenario_.scene().time;
  const std::string what = fmt::format(
      "the error in time stays above the tolerance: a step of {:.3g} s from t = {:.6g} s may add "
      "its share of {}, but the error estimated at {} is {:.2g} times that",
      report.tried, state_.time,
      report.is_of_edge ? "half an edge's length"
                        : fmt::format("time.tolerance {:g}", time.tolerance),
      describe_dof(model_, report.last.worst_dof), report.error);
  return what + (report.at_rounding
                     ? ". That is the rounding of positions, which no step makes smaller: raise "
                       "time.tolerance."
                     : fmt::format(". Shorter steps are below time.minimum_step of {:.3g} s: lower "
                                   "that, or raise time.tolerance.",
                                   time.minimum_step));
}

std::string Simulation::advice_on_steps() const {
  std::string shorter = "take smaller steps";
  switch (scenario_.scene().time.stepping) {
    case scenario::Stepping::Fixed:
      break;
    case scenario::Stepping::Adaptive:
      shorter = "take a smaller tolerance";
      break;
    case scenario::Stepping::Automatic:
      // Half of it resolves the fastest vibration, as pieces of a step do (stability_monitor.cpp).
      shorter = fmt::format(
          "write 'step: {:.2g}', which resolves the fastest vibrations",
          plan_.step / static_cast<double>(std::max<std::int64_t>(2, counters_.most_pieces)));
      break;
  }
  constexpr const char* kConserving =
      "energy_momentum";  // planar, without joints (check_spatial.cpp)
  if (stepper_info_.name == kConserving || model().dimension != 2 || model().has_rotations()) {
    return shorter;
  }
  return fmt::format("{}, or 'integrator: {}', which creates no energy", shorter, kConserving);
}

std::string Simulation::describe_unstable_motion() const {
  return fmt::format(
      "the motion is unstable at t = {:.6g} s: {}, and has been doubtful since t = {:.6g} s. To "
      "get a right result {}; to run on all the same, say 'allow_unstable: true' under 'time'",
      state_.time, describe(model_, state_.audit), state_.audit.unreliable_from, advice_on_steps());
}

std::string Simulation::describe_divergence(const StepReport& report, double dt) {
  return fmt::format("the motion diverged at t = {:.6g} s: {} at {}. {}", state_.time,
                     report.failure, describe_dof(model_, report.worst_dof),
                     stability_->explain_blow_up(initial_state(model_), state_, dt));
}

}  // namespace der
