#pragma once

#include <string>

#include "der/app/terminal.hpp"
#include "der/output/recorder.hpp"
#include "der/output/run.hpp"
#include "der/output/run_folder.hpp"
#include "der/simulation.hpp"

namespace der::app {

/// The text that der_run prints of a scene at once: its title, and what is doubtful about it.
std::string scene_head(const Scenario& scenario, const Style& style);
/// How much a report says: `Full` also says what was not tested, and why.
enum class Detail { Usual, Full };

/// The summary that der_run prints at the end of a run: what ran, with which model and solver and
/// why, what it cost, the probes, and where the results are.
std::string run_report(const Simulation& simulation, const Recorder& recorder,
                       const RunOutcome& outcome, const RunFolder& folder, Detail detail,
                       const Style& style);

/// The text that --check prints once the model is there, which may take seconds.
std::string check_report(const Simulation& simulation, const Style& style);

}  // namespace der::app
