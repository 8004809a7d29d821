#include "der/output/hints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "der/scenario/scenario.hpp"
#include "der/steppers/fine_tables.hpp"

namespace der {
namespace {

/// More steps than users expect of a run with a tolerance.
constexpr std::int64_t kManySteps = 20'000;
/// More than a motion takes that starts no waves: a jump of velocity is the likely cause then.
constexpr std::int64_t kManyAfterKinks = 1'000;
/// Steppers of this order take fewer steps where a motion is smooth.
constexpr int kHighOrder = 4;
/// Ratio of the longest step to the mean one, from which on the motion itself has changed.
constexpr double kGrownRough = 10.0;

std::string about(const std::vector<MotionKink>& kinks, int order) {
  std::string places;
  for (const auto& [path, at] : kinks) {
    places += fmt::format("{}{} at {:g} s", places.empty() ? "" : ", ", path, at);
  }
  return fmt::format(
      ". Supports jump to another velocity where their tables have kinks ({}). That starts waves "
      "of every length, and the steps resolve those that move nodes. For fewer steps, write "
      "'smooth: true' in these tables{}, or choose a larger tolerance, or equal steps (time.step) "
      "of tr_bdf2 or sdirk5, which damp the waves that they do not resolve",
      places, order < kHighOrder ? " and 'integrator: sdirk5' under time" : "");
}

}  // namespace

std::vector<std::string> hints(const Simulation& simulation, const Counters& counters) {
  const std::int64_t steps = counters.steps;
  if (!simulation.adaptive() || steps < kManyAfterKinks) return {};
  const scenario::Time& time = simulation.scenario().scene().time;
  const double mean = simulation.state().time / static_cast<double>(steps);
  const double longest = simulation.longest_step();
  const bool is_even = longest < kGrownRough * mean;
  auto kinks = motion_kinks(simulation.scenario().scene(), simulation.state().time);
  if (!is_even) {  // long steps came after a kink at the start: it is not what made them short
    kinks.erase(std::remove_if(kinks.begin(), kinks.end(),
                               [](const MotionKink& kink) { return kink.time == 0.0; }),
                kinks.end());
  }
  // Steps of order 1 are many without any wave.
  if (!kinks.empty() && (steps >= kManySteps || simulation.integrator().order > 1)) {
    return {fmt::format("time.tolerance: {:g} took {} steps of about {:.2g} s", time.tolerance,
                        steps, mean) +
            about(kinks, simulation.integrator().order)};
  }
  if (steps < kManySteps) return {};
  if (is_even) {
    return {fmt::format(
        "time.tolerance: {:g} took {} steps of about {:.2g} s. It limits the error that all steps "
        "of the whole duration of {:g} s add up to, so that a longer run takes shorter steps. For "
        "fewer steps, choose a larger tolerance or 'integrator: sdirk5'",
        time.tolerance, steps, mean, time.duration)};
  }
  return {fmt::format(
      "time.tolerance: {:g} took {} steps: up to {:.2g} s long at first, {:.2g} s in the mean. The "
      "motion has grown rough: energy passes to ever faster waves, and adaptive steps resolve "
      "them all. Where errors grow exponentially, as in chaos, no step length makes the end right; "
      "'der verify' shows it. For fewer steps, choose a larger tolerance, a shorter duration, "
      "damping under loads, or equal steps (time.step) of tr_bdf2, which damps the waves that it "
      "does not resolve",
      time.tolerance, steps, longest, mean)};
}

}  // namespace der
