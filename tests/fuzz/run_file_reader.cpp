// The fuzz target of the reader of run files. An input is a run file byte by byte, or edits of a
// run (run_file_edits.hpp). All that der reads of such a file is read, as the program and Python
// do: each is refused as an Error or gives data that the next one can take.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "base_runs.hpp"
#include "der/model/followed.hpp"
#include "der/output/io_error.hpp"
#include "der/output/recorder.hpp"
#include "der/output/replay.hpp"
#include "der/output/run_file.hpp"
#include "der/output/run_folder.hpp"
#include "der/output/saved_run.hpp"
#include "der/output/start.hpp"
#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"
#include "run_file_edits.hpp"

namespace {

namespace fs = std::filesystem;
using namespace der::fuzz;

/// More only take longer.
constexpr std::size_t kMostFrames = 100;

const BaseRun& base(std::size_t number) {
  const auto& all = base_runs();
  return all[number % all.size()];
}

template <class F>
void refused_by_name(F&& read) {
  try {
    read();
  } catch (const der::Error&) {  // NOLINT(bugprone-empty-catch): refused by name
  }
}

void put_bytes(const fs::path& path, const char* bytes, std::size_t size) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes, static_cast<std::streamsize>(size));
}

/// A run whose state has been edited before its last frame and its checkpoint were written.
void write_edited(const fs::path& path, const Edits& edits) {
  der::Simulation simulation(der::Scenario::parse(base(edits.base).scene));
  der::Recorder recorder(simulation);
  const auto file = der::RunFile::create(path, simulation, recorder);
  recorder.add(*file);
  recorder.observe(simulation);
  der::State& state = simulation.state();
  for (const Edit& edit : edits.all) {
    if (is_of_state(edit)) edit_state(state, edit);
  }
  const der::Vector none;
  const der::Index positions = simulation.model().dofs.num_positions();
  const auto angles = static_cast<der::Index>(state.positions.size()) - positions;
  const der::Vector probes = der::Vector::Zero(static_cast<der::Index>(recorder.probes().size()));
  file->write(
      {state.time,
       state.step,
       state.positions.head(positions),
       state.velocities.head(positions),
       state.positions.tail(angles),
       state.velocities.tail(angles),
       simulation.model().has_sections() ? der::Vector(state.followed.tail(8 * angles)) : none,
       state.followed.head(der::num_turns(simulation.model())),
       {},
       state.work,
       probes});
  file->finish("stopped", simulation, recorder);
}

void write_input(const fs::path& path, const std::uint8_t* data, std::size_t size) {
  constexpr std::string_view signature = "\x89HDF";
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.substr(0, signature.size()) == signature) {
    return put_bytes(path, bytes.data(), bytes.size());
  }
  const Edits edits = parse_edits(data, size);
  if (std::any_of(edits.all.begin(), edits.all.end(), is_of_state)) {
    write_edited(path, edits);
  } else {
    put_bytes(path, base(edits.base).bytes.data(), base(edits.base).bytes.size());
  }
  edit_file(path, edits.all);
}

Eigen::Map<const der::FrameTable> table(const std::vector<double>& values, std::size_t rows) {
  const std::size_t columns = rows == 0 ? 0 : values.size() / rows;
  return {values.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns)};
}

/// Reads off the frames what was not saved, where they fit the scene, as Python does.
void replay(const der::SavedRun& run) {
  const der::FrameData& data = run.frames;
  const std::size_t frames = data.num_frames();
  if (frames > kMostFrames) return;
  const bool on_path = std::any_of(run.data.begin(), run.data.end(),
                                   [](const auto& set) { return set.name == "path/factor"; });
  const auto scenario = der::Scenario::parse(run.scene);
  der::Replay replay(scenario, data.times, on_path);
  const der::Model& model = replay.model();
  const der::Index edges =
      model.has_sections() ? static_cast<der::Index>(model.framed_edges.size()) : 0;
  if (run.dimension != model.dimension || run.sections != edges ||
      run.turns > der::num_turns(model) ||
      data.positions.size() !=
          frames * static_cast<std::size_t>(model.num_nodes * model.dimension)) {
    return;
  }
  const der::SavedFrames saved{table(data.positions, frames), table(data.velocities, frames),
                               table(data.theta, frames), table(data.section_frames, frames),
                               table(data.turns, frames)};
  replay.reactions(saved, table(data.spin, frames));
  replay.directors(saved);
  for (const char* quantity : {"curvature", "moment", "tension", "vy"}) {
    refused_by_name([&] { replay.along(model.rods.front().name, quantity, saved); });
  }
}

void go_on(const fs::path& path, const der::Scenario& scenario) {
  der::Simulation simulation(scenario);
  der::Recorder recorder(simulation);
  const auto file = der::RunFile::resume(path, simulation, recorder);
  recorder.add(*file);
  simulation.step();
  recorder.observe(simulation);
  file->finish("stopped", simulation, recorder);
}

void start_from(const fs::path& folder, const der::Scenario& scenario) {
  der::Simulation simulation(scenario.with({{"start_from", "'" + folder.string() + "'"}}));
  der::apply_start(simulation);
  simulation.step();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const der::RunFolder folder{fs::path(scratch_folder())};
  const fs::path path = folder.results();
  fs::remove(path);
  write_input(path, data, size);

  const auto successor = der::Scenario::parse(base(size < 2 ? 0 : data[1]).scene);
  der::is_run_file(path);
  der::read_scene(path);
  refused_by_name([&] { replay(der::read_run(path)); });
  refused_by_name([&] {
    if (!successor.scene().is_dynamic()) return static_cast<void>(der::read_last_frame(path));
    start_from(folder.path(), successor);
  });
  refused_by_name([&] { der::check_resumable(folder, successor); });
  refused_by_name([&] { go_on(path, successor); });  // last: it writes
  return 0;
}
