#include "der/output/replay.hpp"

#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "held_nodes.hpp"

namespace der::python {
namespace {

using Frames = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The frames as a table, without a copy. ValueError if they are not those of the replayed run.
Eigen::Map<const FrameTable> to_table(const Frames& frames, const char* name,
                                      const Replay& replay) {
  const Model& model = replay.model();
  const py::tuple wanted = py::make_tuple(replay.num_frames(), model.num_nodes, model.dimension);
  const py::object shape = frames.attr("shape");
  if (!shape.equal(wanted)) {
    throw py::value_error(py::str("{} has the shape {}, not (frames, nodes, dim) = {}")
                              .format(name, shape, wanted)
                              .cast<std::string>());
  }
  return {frames.data(), frames.shape(0), model.num_dofs()};
}

py::tuple along(Replay& replay, const std::string& rod, const std::string& quantity,
                const Frames& positions, const Frames& velocities) {
  const RodSeries series = replay.along(rod, quantity, to_table(positions, "positions", replay),
                                        to_table(velocities, "velocities", replay));
  return py::make_tuple(
      Array(static_cast<py::ssize_t>(series.arc_length.size()), series.arc_length.data()),
      Array({series.values.rows(), series.values.cols()}, series.values.data()));
}

}  // namespace

void bind_replay(py::module_& module) {
  py::class_<Replay>(module, "Replay",
                     "The frames of a run that is over, to read off them what was not saved.\n\n"
                     "Supports stand as the scene has them, not as `Simulation.prescribe` may have "
                     "moved them.")
      .def(py::init<Scenario, std::vector<double>, bool>(), py::arg("scenario"),
           py::arg("instants"), py::arg("on_path") = false,
           "`instants`, shape (frames,), are the times [s] of the frames, or, `on_path`, the "
           "factors of\nthe points of the scene's continuation. Raises SceneError or DerError "
           "where no model can be\nbuilt, and on a path if the scene has no continuation.")
      .def("along", &along, py::arg("rod"), py::arg("quantity"), py::arg("positions"),
           py::arg("velocities"),
           "Return arc lengths [m], shape (samples,), and values in the quantity's SI unit, shape\n"
           "(frames, samples), of a quantity of probes along a rod: at its nodes, at those that "
           "bend, or\nat the middles of its edges. `positions` [m] and `velocities` [m/s] have the "
           "shape\n(frames, nodes, dim). Raises DerError for an unknown rod or quantity, "
           "ValueError for another\nshape.")
      .def(
          "held_nodes",
          [](Replay& replay, std::size_t frame) {
            replay.show(frame);
            return held_nodes(replay.scenario().scene(), replay.model(), replay.state());
          },
          py::arg("frame"),
          "Return every node that a support of the scene holds, with the angle of clamps at a "
          "frame.\n\nRaises DerError if there is no such frame.");
}

}  // namespace der::python
