#pragma once

#include <tuple>
#include <vector>

#include "der/model/fields.hpp"
#include "der/model/state.hpp"
#include "der/simulation.hpp"

namespace der {

/// Running extremes of a probe over every step, saved or not, in the unit of the probe.
struct ProbeSummary {
  double final = 0.0;
  double min = 0.0;
  double max = 0.0;
  double t_min = 0.0;  ///< [s] when `min` was first reached
  double t_max = 0.0;  ///< [s]

  static constexpr auto fields() {
    return std::make_tuple(
        field("final", "", &ProbeSummary::final), field("min", "", &ProbeSummary::min),
        field("max", "", &ProbeSummary::max), field("t_min", "s", &ProbeSummary::t_min),
        field("t_max", "s", &ProbeSummary::t_max));
  }
};
static_assert(lists_all_members<ProbeSummary>());

/// All data needed to continue a run bit for bit as if it had never stopped.
struct Checkpoint {
  State state;
  std::vector<ProbeSummary> extremes;  ///< one a probe
  Counters counters;                   ///< of the run so far
  double wall_seconds = 0.0;           ///< of the run so far

  static constexpr auto fields() {
    return std::make_tuple(
        field("state", "", &Checkpoint::state),
        field("extremes", "", &Checkpoint::extremes, Values::Any, Extent::Probes),
        field("counters", "", &Checkpoint::counters),
        field("wall_seconds", "s", &Checkpoint::wall_seconds));
  }
};
static_assert(lists_all_members<Checkpoint>());

}  // namespace der
