#pragma once

#include <nlohmann/json_fwd.hpp>
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

/// Why the result is unreliable, if the time stepping has created too much energy; else empty.
std::string created_energy_warning(const Simulation& simulation);

/// Reasons why the result of a run is doubtful, in sentences: rods that pass through one another,
/// strains for which no linear law holds, created energy.
std::vector<std::string> doubts(const Simulation& simulation, const RunOutcome& outcome);

/// Reasons to doubt a completed run, in sentences: the scene's own warnings, and those of the run.
std::vector<std::string> warnings(const Simulation& simulation, const RunOutcome& outcome);
/// Those that the scene alone did not tell: those of `doubts`; equal steps that are too long to
/// resolve a table; a structure to which linear buckling does not apply.
std::vector<std::string> warnings_of_run(const Simulation& simulation, const RunOutcome& outcome);

/// The summary of an ended run (keys: docs/results.md), in the order in which a person wants to
/// read it. Values that the run did not come to (the probes of an equilibrium that was not found)
/// are left out; no number is NaN or infinite.
nlohmann::ordered_json summary(const Simulation& simulation, const Recorder& recorder,
                               const RunOutcome& outcome);

/// The text of summary.json.
std::string summary_json(const Simulation& simulation, const Recorder& recorder,
                         const RunOutcome& outcome);

}  // namespace der
