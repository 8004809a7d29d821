#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "der/output/datasets.hpp"
#include "der/output/frame_data.hpp"
#include "der/output/run.hpp"

namespace der::python {

namespace py = pybind11;

/// Everything that a run recorded, in memory; der/simulation.py makes a Result of it.
struct Recording {
  FrameData frames;
  std::vector<Dataset> data;
  std::vector<std::string> probe_names;
  std::vector<std::string> probe_units;
  Index dimension = 0;
  Index sections = 0;  ///< edges that have a section
  Index turns = 0;     ///< edges whose whole turns are followed
};

/// The recorded data of a run that has just ended, and how it ended.
struct RunRecording : Recording {
  RunOutcome outcome;
  std::vector<std::string> doubts;  ///< why its result is unreliable; none: it is not
  nlohmann::ordered_json summary;
};

/// The content of a run file.
struct FileRecording : Recording {
  std::string status;
  std::string scene;
};

/// Runs the simulation `self` from its present state to the end of the scene, to time `until` [s],
/// or until `callback()` returns false after a step, and records it; `tick()` is called now and
/// then. With `out`, the run is also written to that folder while it goes on.
std::unique_ptr<RunRecording> record(const py::object& self,
                                     const std::optional<py::function>& callback, double until,
                                     const std::optional<py::function>& tick,
                                     const std::optional<std::filesystem::path>& out);

}  // namespace der::python
