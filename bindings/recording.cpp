#include "recording.hpp"

#include <pybind11/stl.h>

#include <cstdint>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/model/followed.hpp"
#include "der/output/memory_sink.hpp"
#include "der/output/run_arrays.hpp"
#include "der/output/summary.hpp"
#include "errors.hpp"
#include "json.hpp"
#include "py_simulation.hpp"

namespace der::python {
namespace {

PySimulation::Callback to_callback(const std::optional<py::function>& function) {
  if (!function) return {};
  return [function = *function] { return function().cast<bool>(); };
}

PySimulation::Tick to_tick(const std::optional<py::function>& function) {
  if (!function) return [] {};
  return [function = *function] { function(); };
}

/// A view of the columns of a (frames x columns) table, without a copy; `self` keeps it alive.
py::array_t<double> table_view(const std::vector<double>& data, std::vector<py::ssize_t> shape,
                               const py::object& self) {
  return py::array_t<double>(std::move(shape), data.data(), self);
}

template <std::vector<double> FrameData::* member>
py::array_t<double> vectors(const py::object& self) {
  const auto& recording = self.cast<const Recording&>();
  const std::vector<double>& data = recording.frames.*member;
  const auto frames = static_cast<py::ssize_t>(recording.frames.num_frames());
  const py::ssize_t dimension = recording.dimension;
  const auto entries = static_cast<py::ssize_t>(data.size());
  const py::ssize_t nodes = frames == 0 ? 0 : entries / (frames * dimension);
  return table_view(data, {frames, nodes, dimension}, self);
}

/// The arrays of the sections, or None without any.
py::object sections(const py::object& self) {
  const auto& recording = self.cast<const Recording&>();
  const py::ssize_t edges = recording.sections;
  if (edges == 0) return py::none();
  const auto frames = static_cast<py::ssize_t>(recording.frames.num_frames());
  return py::make_tuple(
      table_view(recording.frames.theta, {frames, edges}, self),
      table_view(recording.frames.spin, {frames, edges}, self),
      table_view(recording.frames.section_frames, {frames, edges, FrameBlock::kSize}, self));
}

py::array_t<double> turns(const py::object& self) {
  const auto& recording = self.cast<const Recording&>();
  const auto frames = static_cast<py::ssize_t>(recording.frames.num_frames());
  return table_view(recording.frames.turns, {frames, py::ssize_t{recording.turns}}, self);
}

py::array_t<double> column(const std::vector<double>& data, const py::object& self) {
  return table_view(data, {static_cast<py::ssize_t>(data.size())}, self);
}

/// The columns of a (frames x names) table by name, copied.
py::dict columns_by_name(const std::vector<double>& table, const std::vector<std::string>& names) {
  const std::size_t count = names.size();
  const auto frames = static_cast<py::ssize_t>(count == 0 ? 0 : table.size() / count);
  const auto row = static_cast<py::ssize_t>(count * sizeof(double));
  py::dict columns;
  for (std::size_t i = 0; i < count; ++i) {
    const double* first = frames == 0 ? nullptr : table.data() + i;
    // Without an owner the array is a copy.
    columns[py::str(names[i])] = py::array_t<double>({frames}, {row}, first);
  }
  return columns;
}

py::dict energy_columns(const Recording& recording) {
  return columns_by_name(recording.frames.energies, names_in_group("energies"));
}

py::dict probe_columns(const Recording& recording) {
  return columns_by_name(recording.frames.probes, recording.probe_names);
}

py::dict work_columns(const Recording& recording) {
  return columns_by_name(recording.frames.work, names_in_group("work"));
}

py::dict analysis_data(const Recording& recording) {
  py::dict data;
  for (const Dataset& dataset : recording.data) {
    const std::vector<py::ssize_t> shape(dataset.shape.begin(), dataset.shape.end());
    data[py::str(dataset.name)] = py::array_t<double>(shape, dataset.values.data());
  }
  return data;
}

py::dict probe_units(const Recording& recording) {
  py::dict units;
  for (std::size_t i = 0; i < recording.probe_names.size(); ++i) {
    units[py::str(recording.probe_names[i])] = recording.probe_units[i];
  }
  return units;
}

}  // namespace

std::unique_ptr<RunRecording> record(const py::object& self,
                                     const std::optional<py::function>& callback, double until,
                                     const std::optional<py::function>& tick,
                                     const std::optional<std::filesystem::path>& out) {
  auto& simulation = self.cast<PySimulation&>();
  auto recording = std::make_unique<RunRecording>();
  const Model& model = simulation.engine().model();
  recording->dimension = model.dimension;
  if (model.has_sections()) recording->sections = static_cast<Index>(model.framed_edges.size());
  recording->turns = num_saved_turns(model);
  Recorder recorder(simulation.engine());
  MemorySink memory;
  recorder.add(memory);
  for (const Probe& probe : recorder.probes()) {
    recording->probe_names.push_back(probe.name());
    recording->probe_units.push_back(probe.unit());
  }
  recording->outcome =
      simulation.run(recorder, until, to_callback(callback), to_tick(tick), out, self);
  recording->frames = std::move(static_cast<FrameData&>(memory));
  recording->data = datasets(simulation.engine(), recording->outcome);
  recording->doubts = doubts(simulation.engine(), recording->outcome);
  recording->summary = summary(simulation.engine(), recorder, recording->outcome);
  return recording;
}

void bind_recording(py::module_& module) {
  py::class_<Recording>(module, "Recording",
                        "The recorded data of a run, from the engine; der.Result is made of "
                        "it.")
      .def_property_readonly(
          "times",
          [](const py::object& self) {
            return column(self.cast<const Recording&>().frames.times, self);
          },
          "Times of the saved frames [s], shape (frames,).")
      .def_property_readonly(
          "steps",
          [](const py::object& self) {
            const std::vector<std::int64_t>& steps = self.cast<const Recording&>().frames.steps;
            return py::array_t<std::int64_t>(static_cast<py::ssize_t>(steps.size()), steps.data(),
                                             self);
          },
          "Time steps done at the saved frames, shape (frames,).")
      .def_property_readonly("positions", &vectors<&FrameData::positions>,
                             "Node positions [m], shape (frames, nodes, dim).")
      .def_property_readonly("velocities", &vectors<&FrameData::velocities>,
                             "Node velocities [m/s], shape (frames, nodes, dim).")
      .def_property_readonly("sections", &sections,
                             "Angles of the edges [rad] and their rates [rad/s], both of shape "
                             "(frames, edges), and\n"
                             "the frames that they count from, shape (frames, edges, 8), in the "
                             "model ``spatial``;\n"
                             "None in other models.")
      .def_property_readonly("turns", &turns,
                             "Angles [rad] by which the edges that the planar model follows have "
                             "turned, whole\nturns included, shape (frames, edges).")
      .def_property_readonly("energies", &energy_columns, "Energies [J] by name, shape (frames,).")
      .def_property_readonly("work", &work_columns,
                             "Works done and energy lost since the start [J] by name, "
                             "shape (frames,).")
      .def_property_readonly("probes", &probe_columns, "Probes by name, shape (frames,).")
      .def_property_readonly(
          "data", &analysis_data,
          "Further results of an analysis, by name; `array_units` has the units.")
      .def_property_readonly("probe_units", &probe_units, "SI units of the probes by name.");
  py::class_<RunRecording, Recording>(module, "RunRecording",
                                      "The recorded data of a run that has just ended.")
      .def_property_readonly(
          "status", [](const RunRecording& r) { return r.outcome.status; }, "How the run ended.")
      .def_property_readonly(
          "error",
          [](const RunRecording& r) -> py::object {
            if (r.outcome.error == nullptr) return py::none();
            return to_python(r.outcome.error);
          },
          "The failure that ended it, an exception of its own class; None if it did not fail.")
      .def_readonly("doubts", &RunRecording::doubts,
                    "Why its result is unreliable though it did not fail; empty if it is not.")
      .def_property_readonly(
          "summary", [](const RunRecording& r) { return to_python(r.summary); },
          "The content of summary.json, a new dict.")
      .def(
          "summary_value",
          [](const RunRecording& r, const std::string& key) -> py::object {
            const auto entry = r.summary.find(key);
            return entry == r.summary.end() ? py::none() : to_python(*entry);
          },
          py::arg("key"),
          "One value of the summary, which costs less than all; None where the key is not in it.");
}

}  // namespace der::python
