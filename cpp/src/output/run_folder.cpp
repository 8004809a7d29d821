#include "der/output/run_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

#include "der/output/io_error.hpp"
#include "der/output/summary.hpp"
#include "der/version.hpp"

namespace der {
namespace {

namespace fs = std::filesystem;

/// HDF5 locks a file that it writes.
bool is_being_written(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool locked = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return locked;
}

/// Other programs see the old file or the whole new one, never a part of it.
void write_file(const fs::path& file, const std::string& text) {
  fs::path temporary = file;
  temporary += ".tmp";
  std::ofstream out(temporary, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out) fs::rename(temporary, file, error);
  if (!out || error) throw IoError("cannot write '" + file.string() + "'");
}

void remove_file(const fs::path& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error) throw IoError("cannot remove '" + file.string() + "': " + error.message());
}

bool is_finished(const std::string& status) {
  return status == "completed" || status == "static_converged";
}

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
                         Recorder& recorder, const StepCallback& after_step) {
  recorder.add(file);
  const RunOutcome outcome = run(simulation, recorder, after_step);
  file.add(datasets(simulation, outcome));
  if (!outcome.path.empty()) write_file(folder.path_table(), path_csv(simulation, outcome));
  file.finish(outcome.status, simulation, recorder);
  write_file(folder.summary(), summary_json(simulation, recorder, outcome));
  return outcome;
}

}  // namespace

void RunFolder::prepare() const {
  std::error_code error;
  const bool is_run = fs::exists(summary(), error) || fs::exists(results(), error);
  if (fs::exists(path_, error) && !fs::is_directory(path_, error)) {
    throw IoError("'" + path_.string() + "' is a file, not a folder for results");
  }
  if (fs::exists(path_, error) && !is_run && !fs::is_empty(path_, error)) {
    throw IoError("'" + path_.string() +
                  "' holds other things than the results of a run, which will not be touched; name "
                  "another folder");
  }
  if (is_being_written(results())) {
    throw IoError("another run is writing its results to '" + path_.string() +
                  "'; wait for it or name another folder");
  }
  fs::create_directories(path_, error);
  if (error) throw IoError("cannot create '" + path_.string() + "': " + error.message());
  // The summary first: what is left must never look like the end of the run that begins now.
  for (const fs::path& file : {summary(), results(), scene(), path_table()}) remove_file(file);
}

RunFileHead check_resumable(const RunFolder& folder, const Scenario& scenario) {
  if (!fs::exists(folder.results())) {
    throw IoError("there is no run in '" + folder.path().string() +
                  "' to resume; run without --resume first");
  }
  if (is_being_written(folder.results())) {
    throw IoError("the run in '" + folder.path().string() + "' is still going on");
  }
  RunFileHead head = read_head(folder.results());
  const std::string scene = scenario.to_yaml();
  if (head.scene != scene) {
    throw ResumeError("the run in '" + folder.path().string() +
                      "' was started with another scene: " + first_difference(head.scene, scene) +
                      ". Resume it with its own " + folder.scene().string() +
                      ", or run the new scene without --resume");
  }
  if (is_finished(head.status)) return head;
  if (head.der_version != version) {
    throw ResumeError("the run was started by der " + head.der_version + " and this is " + version +
                      ", which need not give the same numbers; run it again without --resume");
  }
  if (head.status != "running" && head.status != "stopped") {
    throw ResumeError("the run ended as '" + head.status + "' at t = " + std::to_string(head.time) +
                      " s and would do so again; change the scene and "
                      "run it without --resume");
  }
  if (head.step < 0) {
    throw ResumeError("the run in '" + folder.path().string() +
                      "' ended before it saved anything; run it again without --resume");
  }
  return head;
}

RunOutcome run_in_folder(const RunFolder& folder, Simulation& simulation, Recorder& recorder,
                         const StepCallback& after_step) {
  folder.prepare();
  // The result file first: it marks the folder as one of a run, should the process end right here.
  const auto file = RunFile::create(folder.results(), simulation, recorder);
  write_file(folder.scene(), simulation.scenario().to_yaml());
  return run_into_file(*file, folder, simulation, recorder, after_step);
}

RunOutcome resume_in_folder(const RunFolder& folder, Simulation& simulation, Recorder& recorder,
                            const StepCallback& after_step) {
  const auto file = RunFile::resume(folder.results(), simulation, recorder);
  remove_file(folder.summary());
  return run_into_file(*file, folder, simulation, recorder, after_step);
}

}  // namespace der
