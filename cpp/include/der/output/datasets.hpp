#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "der/output/run.hpp"
#include "der/simulation.hpp"

namespace der {

/// An array of numbers with a name and a unit, on its way to a file or to Python.
struct Dataset {
  std::string name;  ///< with its group: "modes/frequencies"
  std::string unit;  ///< "" for a pure number
  std::vector<std::size_t> shape;
  std::vector<double> values;  ///< last dimension fastest
};

/// Results of an analysis besides shapes and probes (docs/results.md): modes, buckling modes, or
/// the columns of a path. Empty for dynamic and static runs.
std::vector<Dataset> datasets(const Simulation& simulation, const RunOutcome& outcome);

/// The table of a path as CSV, one line a point, with the probes.
std::string path_csv(const Simulation& simulation, const RunOutcome& outcome);

/// "fold", "bifurcation", "out_of_plane", or nothing.
const char* event_name(PathEvent event);

}  // namespace der
