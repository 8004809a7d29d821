#include "der/output/run_folder.hpp"

#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>

#include "der/catalog/run_status.hpp"
#include "der/output/io_error.hpp"
#include "der/output/result_size.hpp"
#include "der/output/summary.hpp"
#include "der/scenario/scenario.hpp"
#include "der/version.hpp"
#include "output/run_lock.hpp"
#include "output/whole_file.hpp"

namespace der {
namespace {

namespace fs = std::filesystem;

/// The first line in which two texts differ, in words.
std::string first_difference(const std::string& was, const std::string& is) {
  std::istringstream old_text(was);
  std::istringstream new_text(is);
  for (int line = 1;; ++line) {
    std::string old_line;
    std::string new_line;
    const bool more_old = static_cast<bool>(std::getline(old_text, old_line));
    const bool more_new = static_cast<bool>(std::getline(new_text, new_line));
    if (!more_old && !more_new) return "";
    if (old_line != new_line || more_old != more_new) {
      return "line " + std::to_string(line) + " was '" + old_line + "' and is '" + new_line + "'";
    }
  }
}

RunOutcome run_into_file(RunFile& file, const RunFolder& folder, Simulation& simulation,
                         Recorder& recorder, const StepCallback& after_step,
                         const CancelCallback& beat) {
  recorder.add(file);
  const RunOutcome outcome = run(simulation, recorder, after_step, beat);
  file.add(datasets(simulation, outcome));
  if (!outcome.path.empty()) write_atomically(folder.path_table(), path_csv(simulation, outcome));
  file.finish(outcome.status, simulation, recorder);
  write_atomically(folder.summary(), summary_json(simulation, recorder, outcome));
  return outcome;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// True for a JSON text with what every version of der has written into a summary.
bool is_summary(const fs::path& file) {
  const auto json = nlohmann::json::parse(text_of(file), nullptr, false);
  return json.is_object() && json.contains("der_version") && json.contains("status");
}

bool is_path_table(const fs::path& file) {
  return text_of(file).rfind("branch,factor,arc,", 0) == 0;
}

bool is_there(const fs::path& file) {
  std::error_code error;
  return fs::exists(fs::symlink_status(file, error));
}

/// Whether a file may have been left by a run that was killed while it started.
bool is_left_over(const RunFolder& folder, const fs::path& file) {
  return file == RunLock::file_in(folder.path()) || file == temporary_name(folder.results());
}

[[noreturn]] void throw_in_use(const RunFolder& folder) {
  throw IoError("another run is writing its results to '" + folder.path().string() +
                "'; wait for it or name another folder");
}

/// Throws IoError if there is anything but leftovers in a folder.
void check_empty(const RunFolder& folder) {
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    if (is_left_over(folder, entry.path())) continue;
    throw IoError(
        "'" + folder.path().string() + "' holds other things than the results of a run ('" +
        entry.path().filename().string() + "'), which will not be touched; name another folder");
  }
}

/// Throws IoError if a file of that name is there and is not what `is_ours` takes for der's.
template <class F>
void check_ours(const fs::path& file, F&& is_ours, const std::string& reason) {
  std::error_code error;
  if (!is_there(file) || (fs::is_regular_file(file, error) && is_ours(file))) return;
  throw IoError("'" + file.string() + "' " + reason +
                ", and would be replaced: move it away, or name another folder for the results");
}

/// Throws IoError where a run must not write into a folder: it holds other things than a run, or
/// a file of one that is not as der left it. `scene`: the text of scene.yaml to be.
void check_replaceable(const RunFolder& folder, const std::string& scene) {
  std::error_code error;
  if (!fs::exists(folder.path(), error)) return;
  if (!fs::is_directory(folder.path(), error)) {
    throw IoError("'" + folder.path().string() + "' is a file, not a folder for results");
  }
  if (!is_there(folder.results()) && !is_there(folder.summary())) return check_empty(folder);
  check_ours(folder.results(), is_run_file, "is not a run file that der can read");
  check_ours(folder.summary(), is_summary, "is not a summary by der");
  check_ours(folder.path_table(), is_path_table, "is not a table of a path by der");
  const auto is_copy = [&](const fs::path& file) {
    const std::string text = text_of(file);
    return text == scene || text == read_scene(folder.results());
  };
  check_ours(folder.scene(), is_copy, "was edited since the run that it belongs to");
}

/// Makes a folder ready for new results and locks it: creates it, or removes the files of the run
/// that it holds but the result file, whose place the new one takes when it is there. Throws
/// IoError, with nothing touched, where that must not be.
std::unique_ptr<RunLock> prepare(const RunFolder& folder, const std::string& scene,
                                 double expected_bytes) {
  if (RunLock::is_held(folder.path())) throw_in_use(folder);
  check_replaceable(folder, scene);
  std::error_code error;
  fs::create_directories(folder.path(), error);
  if (error) {
    throw IoError("cannot create '" + folder.path().string() + "': " + error.message() +
                  "; name a folder where you may write");
  }
  auto lock = std::make_unique<RunLock>(folder.path());
  check_room(expected_bytes, folder.results());
  // The summary first: what is left must never look like the end of the run that begins now.
  for (const fs::path& file : {folder.summary(), folder.scene(), folder.path_table()}) {
    remove_file(file);
  }
  return lock;
}

/// As `check_resumable`, of a run that is not going on.
RunFileHead resumable_head(const RunFolder& folder, const Scenario& scenario) {
  RunFileHead head = read_head(folder.results());
  const std::string scene = scenario.to_yaml();
  if (head.scene != scene) {
    throw ResumeError("the run in '" + folder.path().string() +
                      "' was started with another scene: " + first_difference(head.scene, scene) +
                      ". Resume it with its own " + folder.scene().string() +
                      ", or run the new scene without --resume");
  }
  if (run_status::is_finished(head.status)) {
    if (is_there(folder.summary())) return head;
    head.status = run_status::kRunning;  // it was killed before it wrote its summary
  }
  if (!scenario.scene().is_dynamic()) {
    throw ResumeError("the analysis in '" + folder.path().string() +
                      "' did not reach its end, and has no steps to go on from; run it again "
                      "without --resume");
  }
  if (head.der_version != version) {
    throw ResumeError("the run was started by der " + head.der_version + " and this is " + version +
                      ", which need not give the same numbers; run it again without --resume");
  }
  if (head.status != run_status::kRunning && head.status != run_status::kStopped) {
    throw ResumeError("the run ended as '" + head.status + "' at t = " + std::to_string(head.time) +
                      " s and would do so again; change the scene and "
                      "run it without --resume");
  }
  if (!head.has_checkpoint) {
    throw ResumeError("the run in '" + folder.path().string() +
                      "' ended before it saved anything; run it again without --resume");
  }
  return head;
}

}  // namespace

RunFileHead check_resumable(const RunFolder& folder, const Scenario& scenario) {
  if (!fs::exists(folder.results())) {
    throw IoError("there is no run in '" + folder.path().string() +
                  "' to resume; run without --resume first");
  }
  if (RunLock::is_held(folder.path())) throw_in_use(folder);
  return resumable_head(folder, scenario);
}

RunOutcome run_in_folder(const RunFolder& folder, Simulation& simulation, Recorder& recorder,
                         const StepCallback& after_step, const CancelCallback& beat) {
  const std::string scene = simulation.scenario().to_yaml();
  const auto lock = prepare(folder, scene, expected_bytes(simulation));
  // The result file first: it marks the folder as one of a run, should the process end right here.
  const auto file = RunFile::create(folder.results(), simulation, recorder);
  write_atomically(folder.scene(), scene);
  return run_into_file(*file, folder, simulation, recorder, after_step, beat);
}

RunOutcome resume_in_folder(const RunFolder& folder, Simulation& simulation, Recorder& recorder,
                            const StepCallback& after_step) {
  const RunLock lock(folder.path());
  // Another program may have gone on with it since it was looked at.
  if (run_status::is_finished(resumable_head(folder, simulation.scenario()).status)) {
    throw ResumeError("the run in '" + folder.path().string() + "' is finished already");
  }
  const auto file = RunFile::resume(folder.results(), simulation, recorder);
  remove_file(folder.summary());
  return run_into_file(*file, folder, simulation, recorder, after_step, {});
}

void save_in_folder(const RunFolder& folder, const Scenario& scenario, const Model& model,
                    const SavedRun& run, const std::string& summary_json) {
  const std::string scene = scenario.to_yaml();
  const auto lock = prepare(folder, scene, 0.0);
  write_run(folder.results(), scenario, model, run);
  write_atomically(folder.scene(), scene);
  write_atomically(folder.summary(), summary_json);
}

}  // namespace der
