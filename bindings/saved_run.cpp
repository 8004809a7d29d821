#include "der/output/saved_run.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/model/followed.hpp"
#include "der/output/run_arrays.hpp"
#include "der/output/run_folder.hpp"
#include "recording.hpp"

namespace der::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::unique_ptr<FileRecording> read(const std::filesystem::path& file) {
  auto recording = std::make_unique<FileRecording>();
  const py::gil_scoped_release unlocked;
  SavedRun run = read_run(file);
  recording->status = std::move(run.status);
  recording->scene = std::move(run.scene);
  recording->dimension = run.dimension;
  recording->sections = run.sections;
  recording->turns = run.turns;
  recording->probe_names = std::move(run.probe_names);
  recording->probe_units = std::move(run.probe_units);
  recording->frames = std::move(run.frames);
  recording->data = std::move(run.data);
  return recording;
}

std::vector<double> numbers(const Numbers& array, const std::vector<py::ssize_t>& shape,
                            const std::string& name) {
  if (!std::equal(shape.begin(), shape.end(), array.shape(), array.shape() + array.ndim())) {
    throw py::value_error("the shape of " + name + " does not fit the model and the times");
  }
  return {array.data(), array.data() + array.size()};
}

/// The columns side by side, one row a frame, in the order of `names`.
std::vector<double> table(const py::dict& columns, const std::vector<std::string>& names,
                          std::size_t frames) {
  const std::size_t width = names.size();
  std::vector<double> rows(width * frames);
  for (std::size_t i = 0; i < width; ++i) {
    const std::string& name = names[i];
    if (!columns.contains(name)) throw py::value_error("there is no column " + name);
    const auto column =
        numbers(columns[py::str(name)].cast<Numbers>(), {static_cast<py::ssize_t>(frames)}, name);
    for (std::size_t frame = 0; frame < frames; ++frame) rows[frame * width + i] = column[frame];
  }
  return rows;
}

std::vector<Dataset> to_datasets(const py::dict& data) {
  std::vector<Dataset> result;
  for (const auto& [key, value] : data) {
    const auto name = key.cast<std::string>();
    const auto array = value.cast<Numbers>();
    const RunArray* known = find_run_array(name);
    if (known == nullptr) throw py::value_error("run files have no array '" + name + "'");
    result.push_back({name,
                      known->unit,
                      {array.shape(), array.shape() + array.ndim()},
                      {array.data(), array.data() + array.size()}});
  }
  return result;
}

void save(const std::filesystem::path& folder, const Scenario& scenario, const Model& model,
          const py::object& result, const std::string& summary_json) {
  SavedRun run;
  run.status = result.attr("status").cast<std::string>();
  for (const auto& [name, probe] : result.attr("probes").cast<py::dict>()) {
    run.probe_names.push_back(name.cast<std::string>());
    run.probe_units.push_back(probe.attr("unit").cast<std::string>());
  }
  const auto times = result.attr("times").cast<Numbers>();
  const auto frames = static_cast<std::size_t>(times.size());
  const std::vector<py::ssize_t> column{times.size()};
  const std::vector<py::ssize_t> vectors{times.size(), model.num_nodes, model.dimension};
  const auto steps = result.attr("steps").cast<py::array_t<std::int64_t>>();
  if (steps.size() != times.size()) throw py::value_error("there must be as many steps as times");
  run.frames.times = numbers(times, column, "times");
  run.frames.steps = steps.cast<std::vector<std::int64_t>>();
  run.frames.positions = numbers(result.attr("positions").cast<Numbers>(), vectors, "positions");
  run.frames.velocities = numbers(result.attr("velocities").cast<Numbers>(), vectors, "velocities");
  if (model.has_sections()) {
    const auto edges = static_cast<py::ssize_t>(model.framed_edges.size());
    const std::vector<py::ssize_t> angles{times.size(), edges};
    const py::object sections = result.attr("sections");
    if (sections.is_none()) throw py::value_error("a run in space needs its sections");
    run.frames.theta = numbers(sections.attr("theta").cast<Numbers>(), angles, "theta");
    run.frames.spin = numbers(sections.attr("spin").cast<Numbers>(), angles, "spin");
    run.frames.section_frames =
        numbers(sections.attr("frames").cast<Numbers>(), {times.size(), edges, FrameBlock::kSize},
                "the frames of sections");
  }
  if (num_saved_turns(model) > 0) {
    const py::object turns = result.attr("turns");
    if (turns.is_none()) throw py::value_error("the run needs the turns of its edges");
    run.frames.turns = numbers(turns.cast<Numbers>(),
                               {times.size(), py::ssize_t{num_saved_turns(model)}}, "turns");
  }
  run.frames.energies = table(result.attr("energies"), names_in_group("energies"), frames);
  run.frames.work = table(result.attr("work"), names_in_group("work"), frames);
  run.frames.probes = table(result.attr("probes"), run.probe_names, frames);
  run.data = to_datasets(result.attr("data"));
  const py::gil_scoped_release unlocked;
  save_in_folder(RunFolder(folder), scenario, model, run, summary_json);
}

}  // namespace

void bind_saved_run(py::module_& module) {
  py::class_<FileRecording, Recording>(module, "FileRecording", "The content of a run file.")
      .def_readonly("status", &FileRecording::status,
                    "How the run ended; `running` while it goes on and after a kill.")
      .def_readonly("scene", &FileRecording::scene, "YAML text of the scene as run.");
  module.def("read_run", &read, py::arg("file"),
             "Read a results.h5. Raises DerError where it is damaged or of another version.");
  module.def("save_run", &save, py::arg("folder"), py::arg("scenario"), py::arg("model"),
             py::arg("result"), py::arg("summary_json"),
             "Write the folder of a Result. Raises ValueError where its arrays do not fit the "
             "model, DerError where the folder must not be written to.");
}

}  // namespace der::python
