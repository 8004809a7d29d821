#pragma once

#include <vector>

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
};

/// All it takes to go on with a run as if it had never stopped, bit for bit.
struct Checkpoint {
  State state;
  std::vector<ProbeSummary> extremes;  ///< one a probe
  Counters counters;                   ///< of the run so far
  double wall_seconds = 0.0;           ///< of the run so far
};

}  // namespace der
