#include "der/output/replay.hpp"

#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "der/core/index.hpp"
#include "der/model/location.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"
#include "der/supports/clamp.hpp"

namespace der::python {
namespace {

/// A node that a support of the scene holds, for drawings.
struct HeldNode {
  std::string rod;
  Index node = 0;
  std::vector<std::string> components;  ///< held or moved by a table: x, y, z
  std::optional<double> tangent_angle;  ///< [rad] from the x axis, of a clamp
};

std::vector<std::string> held_components(Index node, const Model& model) {
  const std::array<const char*, 3> names{"x", "y", "z"};
  std::vector<std::string> result;
  for (int c = 0; c < model.dimension; ++c) {
    if (!model.dofs.is_free(model.dof(node, c))) result.emplace_back(names[to_size(c)]);
  }
  return result;
}

/// The initial angle of the clamp where the rod has no bending stiffness to carry its moment.
double clamp_angle(const RodLayout& rod, Index place, const Replay& replay) {
  const Clamp* clamp = rod.clamp_at(place);
  return clamp == nullptr ? initial_tangent_angle(rod, place, replay.model())
                          : tangent_angle(*clamp, replay.model(), replay.state());
}

std::vector<HeldNode> held_nodes(Replay& replay, std::size_t frame) {
  replay.show(frame);
  std::vector<HeldNode> result;
  for (const scenario::Support& support : replay.scenario().scene().supports) {
    if (!support.holds()) continue;
    const RodLayout& rod = replay.model().rod(support.rod);
    for (const Index place : nodes_at(support.at, rod)) {
      const Index node = rod.nodes[to_size(place)];
      HeldNode held{rod.name, node, held_components(node, replay.model()), std::nullopt};
      if (support.clamps()) held.tangent_angle = clamp_angle(rod, place, replay);
      result.push_back(held);
    }
  }
  return result;
}

/// The arc lengths [m] of a load: its places, or the two ends of its part; none without a place.
std::vector<double> load_arc_lengths(const Replay& replay, std::size_t number) {
  const auto arc_lengths = [&](const auto& load) -> std::vector<double> {
    using Kind = std::decay_t<decltype(load)>;
    if constexpr (std::is_base_of_v<scenario::AtPlace, Kind>) {
      return arc_lengths_of(load.at, replay.model().rod(load.rod));
    } else if constexpr (std::is_base_of_v<scenario::OnPart, Kind>) {
      return {load.from, load.to};
    } else {
      return {};
    }
  };
  return std::visit(arc_lengths, replay.scenario().scene().loads.at(number).what);
}

std::vector<HeldNode> held_nodes_at(const Scenario& scenario, double time) {
  Replay replay(scenario, {time}, false);
  return held_nodes(replay, 0);
}

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

void bind_held_node(py::module_& module) {
  py::class_<HeldNode>(module, "HeldNode", "A node that a support of the scene holds.")
      .def_readonly("rod", &HeldNode::rod, "Name of the rod.")
      .def_readonly("node", &HeldNode::node, "Row number of the node in `positions`.")
      .def_readonly("components", &HeldNode::components,
                    "Components that are held, or moved by a table: x, y, z.")
      .def_readonly("tangent_angle", &HeldNode::tangent_angle,
                    "Angle [rad] from the x axis that a clamp holds the tangent at; None without.")
      .def("__repr__", [](const HeldNode& held) {
        return py::str("<der.HeldNode {} of {!r}: {}{}>")
            .format(held.node, held.rod, py::str(", ").attr("join")(held.components),
                    held.tangent_angle ? ", clamped" : "");
      });
  module.def(
      "held_nodes", &held_nodes_at, py::arg("scenario"), py::arg("time") = 0.0,
      "Return every node that a support of the scene holds, with the angle of clamps at `time` "
      "[s].");
}

}  // namespace

void bind_replay(py::module_& module) {
  bind_held_node(module);
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
      .def("held_nodes", &held_nodes, py::arg("frame"),
           "Return every node that a support of the scene holds, with the angle of clamps at a "
           "frame.\n\nRaises DerError if there is no such frame.")
      .def(
          "load_arc_lengths", &load_arc_lengths, py::arg("number"),
          "Return the arc lengths [m] of a load of the scene, counted from 0: those of its places, "
          "or\nthe two ends of its part; none for a load without a place.\n\nRaises IndexError if "
          "there is no such load.");
}

}  // namespace der::python
