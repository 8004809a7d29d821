#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "der/core/error.hpp"
#include "der/output/recorder.hpp"
#include "der/output/run.hpp"
#include "der/output/run_file.hpp"
#include "der/output/saved_run.hpp"
#include "der/simulation.hpp"

namespace der {

/// The folder of a run: summary.json, results.h5, scene.yaml and, after a continuation,
/// path.csv (docs/results.md).
class RunFolder {
 public:
  explicit RunFolder(std::filesystem::path path) : path_(std::move(path)) {}
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path summary() const { return path_ / "summary.json"; }
  [[nodiscard]] std::filesystem::path results() const { return path_ / "results.h5"; }
  [[nodiscard]] std::filesystem::path scene() const { return path_ / "scene.yaml"; }
  [[nodiscard]] std::filesystem::path path_table() const { return path_ / "path.csv"; }

 private:
  std::filesystem::path path_;
};

/// A run that cannot be resumed, and why.
class ResumeError : public Error {
 public:
  explicit ResumeError(const std::string& message) : Error("resume_error", message) {}
};

/// The head of the run in a folder, which is either at its end (`completed`, `static_converged`) or
/// can be resumed with this scenario. Throws ResumeError if the scenario is another one, if the run
/// has failed or has not saved anything yet; IoError if there is no run.
RunFileHead check_resumable(const RunFolder& folder, const Scenario& scenario);

/// Runs a simulation, as `run` does, with its results in a folder that is made ready for it: the
/// files of a run that it holds are replaced. Throws IoError, with nothing touched, if it is in use
/// by another run, holds other things than a run, or a scene.yaml that was edited since, or if the
/// disk has too little room.
RunOutcome run_in_folder(const RunFolder& folder, Simulation& simulation, Recorder& recorder,
                         const StepCallback& after_step = {}, const CancelCallback& beat = {});
/// Goes on with an interrupted run; what comes out is the same, bit for bit, as if it had never
/// been interrupted. Throws as `check_resumable` does.
RunOutcome resume_in_folder(const RunFolder& folder, Simulation& simulation, Recorder& recorder,
                            const StepCallback& after_step = {});
/// Writes a run that is over, without checkpoints, into a folder that is made ready for it as
/// above.
void save_in_folder(const RunFolder& folder, const Scenario& scenario, const Model& model,
                    const SavedRun& run, const std::string& summary_json);

}  // namespace der
