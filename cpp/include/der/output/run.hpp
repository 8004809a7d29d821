#pragma once

#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "der/catalog/run_status.hpp"
#include "der/output/recorder.hpp"
#include "der/simulation.hpp"
#include "der/statics/equilibrium.hpp"

namespace der {

/// Called after every step; return false to stop the run early (status "stopped").
using StepCallback = std::function<bool(const Simulation&)>;
/// A beat throws this to stop an analysis: the outcome is then `stopped` and has nothing else.
struct Stopped {};

/// Results of the analysis of a planar model for motion out of the plane. The report of the
/// equilibrium has its own (EquilibriumReport::out_of_plane), and so have the points of a path.
struct OutOfPlaneAnswer {
  double growth_rate = 0.0;     ///< [1/s] of the fastest motion, of a modes analysis
  OutOfPlaneBuckling buckling;  ///< of a buckling analysis
};

/// How a run ended. `status` is one of catalog/run_status.hpp or that of the error.
struct RunOutcome {
  std::string status;
  std::string message;        ///< of the failure, empty otherwise
  std::exception_ptr error;   ///< the failure as it was thrown, null otherwise
  double time = 0.0;          ///< [s] that the simulation has reached
  Counters counters;          ///< earlier parts of a resumed run included
  double wall_seconds = 0.0;  ///< earlier parts of a resumed run included
  /// Report of the equilibrium search; set if the analysis needs an equilibrium and it was found.
  std::optional<EquilibriumReport> equilibrium;
  std::vector<Mode> modes;       ///< of a modes analysis
  LinearBuckling buckling;       ///< of a buckling analysis
  std::vector<PathBranch> path;  ///< of a continuation, and the probes of each of its points
  std::vector<std::vector<double>> path_probes;
  OutOfPlaneAnswer out_of_plane;  ///< of a planar model
  /// Where a rod was seen first to pass through itself or another, which nothing prevents.
  std::optional<CrossingMonitor::Crossing> crossing;
  /// Where a rod was seen first to be strained beyond what a linear law holds for.
  std::optional<StrainMonitor::Strained> strained;
  [[nodiscard]] bool ok() const { return run_status::is_finished(status); }
  [[nodiscard]] bool failed() const { return !message.empty(); }
};

/// Runs a simulation from its present state to the end of the scene, or does the scene's analysis,
/// feeding the recorder: one frame with the equilibrium, or one for each point of a path. Numerical
/// failures end the run and are reported in the outcome, with everything up to the last good step
/// recorded; other errors (of a sink, of the callback) propagate, and what `beat` throws, but for
/// `Stopped`. It is called in analyses, where there are no steps, at least once an iteration.
RunOutcome run(Simulation& simulation, Recorder& recorder, const StepCallback& after_step = {},
               const CancelCallback& beat = {});

}  // namespace der
