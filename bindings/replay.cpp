#include "der/output/replay.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "arguments.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "der/core/index.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/model/followed.hpp"
#include "der/model/location.hpp"
#include "der/output/vertex_strain.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/spatial_clamp.hpp"

namespace der::python {
namespace {

/// A node that a support of the scene holds, for drawings.
struct HeldNode {
  std::string rod;
  Index node = 0;
  std::vector<std::string> components;  ///< held or moved by a table: x, y, z
  std::optional<double> tangent_angle;  ///< [rad] from the x axis, of a clamp in a plane
  std::vector<double> tangent;          ///< unit vector, of a clamp; else none
  bool slides = false;                  ///< a clamp, along its tangent
};

std::vector<std::string> held_components(Index node, const Model& model) {
  const std::array<const char*, 3> names{"x", "y", "z"};
  std::vector<std::string> result;
  for (int c = 0; c < model.dimension; ++c) {
    if (!model.dofs.is_free(model.dof(node, c))) result.emplace_back(names[to_size(c)]);
  }
  return result;
}

/// Enters the tangent that a clamp holds: the initial one where the rod has no bending stiffness to
/// carry its moment.
void enter_tangent(HeldNode& held, const RodMesh& rod, Index place, const Replay& replay) {
  const Clamp* clamp = rod.clamp_at(place);
  const Model& model = replay.model();
  if (model.dimension == 3) {
    Vec3 tangent = clamp == nullptr ? initial_tangent(rod, place, model)
                                    : held_frame(clamp->held, model, replay.state()).tangent;
    if (const Index rotation = rod.rotation_at(place); rotation >= 0) {
      tangent = joint_block(model, rotation).rotation(replay.state().followed) * tangent;
    }
    held.tangent.assign(tangent.begin(), tangent.end());
    return;
  }
  double angle = clamp == nullptr ? initial_tangent_angle(rod, place, model)
                                  : tangent_angle(*clamp, model, replay.state());
  for (const HeldDof& rotation : model.held) {
    if (rod.rotation_at(place) < 0 || rotation.displacement < 0) continue;
    if (rotation.dof != model.dofs.rotation(rod.rotation_at(place))) continue;
    angle += control_value(model, replay.state(), rotation.displacement);
  }
  held.tangent_angle = angle;
  held.tangent = {std::cos(angle), std::sin(angle)};
}

std::vector<HeldNode> held_nodes(Replay& replay, std::size_t frame) {
  replay.show(frame);
  std::vector<HeldNode> result;
  for (const scenario::Support& support : replay.scenario().scene().supports) {
    if (!support.holds()) continue;
    const RodMesh& rod = replay.model().rod(support.rod);
    for (const Index place : nodes_at(support.at, rod)) {
      const Index node = rod.nodes[to_size(place)];
      HeldNode held{rod.name, node, held_components(node, replay.model()), std::nullopt, {}};
      if (support.clamps()) {
        enter_tangent(held, rod, place, replay);
        Index along = 0;
        Eigen::Map<const Vector>(held.tangent.data(), replay.model().dimension)
            .cwiseAbs()
            .maxCoeff(&along);
        held.slides = !support.clamps(static_cast<scenario::Component>(along));
      }
      result.push_back(held);
    }
  }
  return result;
}

/// The arc lengths [m] of a load: its places, or the two ends of its part; none without a place.
std::vector<double> load_arc_lengths(const Replay& replay, const WholeNumber& given) {
  const std::int64_t number = given.at_least(0, "the number of the load");
  const std::vector<scenario::Load>& loads = replay.scenario().scene().loads;
  if (number >= static_cast<std::int64_t>(loads.size())) {
    throw py::index_error(
        fmt::format("there is no load {}: the scene has {}, counted from 0", number, loads.size()));
  }
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
  return std::visit(arc_lengths, loads[static_cast<std::size_t>(number)].what);
}

std::vector<HeldNode> held_nodes_at(const Scenario& scenario, double time) {
  Replay replay(scenario, {time}, false);
  return held_nodes(replay, 0);
}

using Frames = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The frames as a table, without a copy. ValueError if they are not of that shape.
Eigen::Map<const FrameTable> to_table(const Frames& frames, const char* name, const char* axes,
                                      const py::tuple& wanted) {
  const py::object shape = frames.attr("shape");
  if (!shape.equal(wanted)) {
    throw py::value_error(py::str("{} has the shape {}, not {} = {}")
                              .format(name, shape, axes, wanted)
                              .cast<std::string>());
  }
  const py::ssize_t rows = frames.shape(0);
  return {frames.data(), rows, rows == 0 ? 0 : frames.size() / rows};
}

/// The arrays of a run as the engine takes them. ValueError if they are not those of the replayed
/// run.
SavedFrames to_frames(const Replay& replay, const Frames& positions, const Frames& velocities,
                      const Frames& theta, const Frames& section_frames, const Frames& turns) {
  const Model& model = replay.model();
  const std::size_t frames = replay.num_frames();
  const Index edges = model.dofs.num_angles();
  const py::tuple nodes = py::make_tuple(frames, model.num_nodes, model.dimension);
  // The replay follows the slopes of rods besides.
  const py::ssize_t given = turns.ndim() == 2 ? turns.shape(1) : 0;
  const py::ssize_t followed = std::min(given, py::ssize_t{num_saved_turns(model)});
  return {to_table(positions, "positions", "(frames, nodes, dim)", nodes),
          to_table(velocities, "velocities", "(frames, nodes, dim)", nodes),
          to_table(theta, "theta", "(frames, edges)", py::make_tuple(frames, edges)),
          to_table(section_frames, "the frames of sections", "(frames, edges, 8)",
                   py::make_tuple(frames, edges, FrameBlock::kSize)),
          to_table(turns, "turns", "(frames, followed edges)", py::make_tuple(frames, followed))};
}

py::tuple along(Replay& replay, const Text& rod, const Text& quantity, const Frames& positions,
                const Frames& velocities, const Frames& theta, const Frames& section_frames,
                const Frames& turns) {
  const RodSeries series =
      replay.along(std::string(rod.value("the name of the rod")),
                   std::string(quantity.value("the name of the quantity")),
                   to_frames(replay, positions, velocities, theta, section_frames, turns));
  return py::make_tuple(
      Array(static_cast<py::ssize_t>(series.arc_length.size()), series.arc_length.data()),
      Array({series.values.rows(), series.values.cols()}, series.values.data()));
}

Array directors(Replay& replay, const Frames& positions, const Frames& velocities,
                const Frames& theta, const Frames& section_frames, const Frames& turns) {
  const FrameTable table =
      replay.directors(to_frames(replay, positions, velocities, theta, section_frames, turns));
  return Array({py::ssize_t{table.rows()}, py::ssize_t{table.cols() / 3}, py::ssize_t{3}},
               table.data());
}

py::tuple reactions(Replay& replay, const Frames& positions, const Frames& velocities,
                    const Frames& theta, const Frames& section_frames, const Frames& turns,
                    const Frames& spin) {
  const SavedFrames frames = to_frames(replay, positions, velocities, theta, section_frames, turns);
  const Index edges = replay.model().dofs.num_angles();
  const ReactionSeries series = replay.reactions(
      frames,
      to_table(spin, "spin", "(frames, edges)", py::make_tuple(replay.num_frames(), edges)));
  const auto vectors = [](const FrameTable& table) {
    return Array({py::ssize_t{table.rows()}, py::ssize_t{table.cols() / 3}, py::ssize_t{3}},
                 table.data());
  };
  return py::make_tuple(places_of(series.places), vectors(series.points), vectors(series.forces),
                        vectors(series.moments));
}

py::tuple actuation_forces(Replay& replay, const Frames& positions, const Frames& velocities,
                           const Frames& theta, const Frames& section_frames, const Frames& turns) {
  const ActuationForceSeries series = replay.actuation_forces(
      to_frames(replay, positions, velocities, theta, section_frames, turns));
  const Eigen::Index frames = series.values.rows();
  return py::make_tuple(
      stretches_of(series.actuations),
      Array({frames, series.values.cols() / 2, Eigen::Index{2}}, series.values.data()));
}

void bind_held_node(py::module_& module) {
  py::class_<HeldNode>(module, "HeldNode", "A node that a support of the scene holds.")
      .def_readonly("rod", &HeldNode::rod, "Name of the rod.")
      .def_readonly("node", &HeldNode::node, "Row number of the node in `positions`.")
      .def_readonly("components", &HeldNode::components,
                    "Components that are held, or moved by a table: x, y, z.")
      .def_readonly("tangent_angle", &HeldNode::tangent_angle,
                    "Angle [rad] from the x axis that a clamp in a plane holds the tangent at; "
                    "None without.")
      .def_property_readonly(
          "tangent",
          [](const HeldNode& held) -> std::optional<Array> {
            if (held.tangent.empty()) return std::nullopt;
            return Array(static_cast<py::ssize_t>(held.tangent.size()), held.tangent.data());
          },
          "Unit vector, shape (dim,), that a clamp holds the tangent along; None without.")
      .def_readonly("slides", &HeldNode::slides,
                    "Whether a clamp lets the node move along that tangent.")
      .def("__repr__", [](const HeldNode& held) {
        return py::str("<der.HeldNode {} of {!r}: {}{}>")
            .format(held.node, held.rod, py::str(", ").attr("join")(held.components),
                    held.tangent.empty() ? "" : ", clamped");
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
           py::arg("velocities"), py::arg("theta"), py::arg("section_frames"), py::arg("turns"),
           "Return arc lengths [m], shape (samples,), and values in the quantity's SI unit, shape\n"
           "(frames, samples), of a quantity of probes along a rod: at its nodes, at those that "
           "bend, or\nat the middles of its edges. `positions` [m] and `velocities` [m/s] have the "
           "shape\n(frames, nodes, dim), `theta` [rad] (frames, edges), `section_frames` (frames, "
           "edges, 8): without\nsections there are 0 edges; `turns` [rad] (frames, followed "
           "edges). Raises DerError for an unknown rod or "
           "quantity, or one that the model\nhas not, ValueError for another shape.")
      .def("directors", &directors, py::arg("positions"), py::arg("velocities"), py::arg("theta"),
           py::arg("section_frames"), py::arg("turns"),
           "Return director 1 of the section of each edge, shape (frames, edges, 3); the arrays as "
           "for\n`along`.")
      .def("reactions", &reactions, py::arg("positions"), py::arg("velocities"), py::arg("theta"),
           py::arg("section_frames"), py::arg("turns"), py::arg("spin"),
           "Return places of supports, and points [m], forces [N] and moments [N m] on the rods "
           "there,\neach of shape (frames, places, 3); the arrays as for `along`, `spin` [rad/s] "
           "of shape (frames, edges).")
      .def("actuation_forces", &actuation_forces, py::arg("positions"), py::arg("velocities"),
           py::arg("theta"), py::arg("section_frames"), py::arg("turns"),
           "Return actuations (name, rod, length [m], number of values), and the moments [N m] or "
           "forces\n[N] that they exert on the rods, shape (frames, actuations, 2); the arrays as "
           "for `along`.")
      .def(
          "held_nodes",
          [](Replay& replay, const WholeNumber& frame) {
            return held_nodes(
                replay, static_cast<std::size_t>(frame.at_least(0, "the number of the frame")));
          },
          py::arg("frame"),
          "Return every node that a support of the scene holds, with the angle of clamps at a "
          "frame.\n\nRaises DerError if there is no such frame.")
      .def(
          "load_arc_lengths", &load_arc_lengths, py::arg("number"),
          "Return the arc lengths [m] of a load of the scene, counted from 0: those of its places, "
          "or\nthe two ends of its part; none for a load without a place.\n\nRaises IndexError if "
          "there is no such load.");
}

}  // namespace der::python
