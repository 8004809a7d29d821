#pragma once

#include <string>
#include <vector>

#include "der/output/recorder.hpp"
#include "der/output/run.hpp"
#include "der/simulation.hpp"

namespace der {

/// The linear solver of a run, and why.
struct UsedSolver {
  std::string name;  ///< "none" for explicit steps, which solve no equations
  std::string reason;
};
UsedSolver used_solver(const Simulation& simulation);

/// Why the result is unreliable where the time stepping has created energy worth mentioning; empty
/// if it has not.
std::string created_energy_warning(const Simulation& simulation);

/// What makes a completed run doubtful, in sentences: the scene's own warnings, or that the time
/// stepping has created energy worth mentioning, its equal steps are longer than a table is fine,
/// or linear buckling was asked about a structure that bends before it buckles.
std::vector<std::string> warnings(const Simulation& simulation, const RunOutcome& outcome);

/// The summary of an ended run as JSON text (keys: docs/results.md). Values that the run did not
/// come to (the probes of an equilibrium that was not found) are left out; no number is NaN or
/// infinite.
std::string summary_json(const Simulation& simulation, const Recorder& recorder,
                         const RunOutcome& outcome);

}  // namespace der
