#include "der/output/hints.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "der/scenario/scenario.hpp"

namespace der {
namespace {

/// Steps that nobody expects of a run with a tolerance.
constexpr std::int64_t kManySteps = 20'000;
/// The longest step against the mean one, from where on the motion itself has changed.
constexpr double kGrownRough = 10.0;

}  // namespace

std::vector<std::string> hints(const Simulation& simulation) {
  const std::int64_t steps = simulation.counters().steps;
  if (!simulation.adaptive() || steps < kManySteps) return {};
  const scenario::Time& time = simulation.scenario().scene().time;
  const double mean = simulation.state().time / static_cast<double>(steps);
  const double longest = simulation.longest_step();
  if (longest < kGrownRough * mean) {
    return {fmt::format(
        "time.tolerance: {:g} took {} steps of about {:.2g} s. It is the error that all steps of "
        "the whole duration of {:g} s may add together, so that a longer run takes shorter steps: "
        "a larger tolerance takes fewer, and so does 'integrator: sdirk5'",
        time.tolerance, steps, mean, time.duration)};
  }
  return {fmt::format(
      "time.tolerance: {:g} took {} steps: up to {:.2g} s long at first, {:.2g} s in the mean. The "
      "motion has grown rough: it hands energy on to ever faster waves, and a tolerance follows "
      "them all. Where errors grow with the motion, as in chaos, no step length makes the end "
      "right; 'der verify' tells. Fewer steps take a larger tolerance, a shorter duration, damping "
      "under loads, or equal steps (time.step) of tr_bdf2, which damps the waves that it does not "
      "follow",
      time.tolerance, steps, longest, mean)};
}

}  // namespace der
