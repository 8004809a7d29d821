#include "held_nodes.hpp"

#include <pybind11/stl.h>

#include <array>

#include "bindings.hpp"
#include "der/core/index.hpp"
#include "der/model/builder.hpp"
#include "der/model/location.hpp"
#include "der/scenario/reader.hpp"
#include "der/supports/clamp.hpp"

namespace der::python {
namespace {

std::vector<std::string> held_components(const scenario::Support& support, int dimension) {
  const std::array<const char*, 3> names{"x", "y", "z"};
  std::array<bool, 3> held{};
  for (const auto component : support.fix) held[static_cast<std::size_t>(component)] = true;
  for (const auto& moved : support.prescribe) {
    held[static_cast<std::size_t>(moved.component)] = true;
  }
  std::vector<std::string> result;
  for (std::size_t c = 0; c < at(dimension); ++c) {
    if (held[c] || support.clamp) result.emplace_back(names[c]);
  }
  return result;
}

/// Also where the rod has no stiffness that would take the clamp's moment.
double clamp_angle(const RodLayout& rod, Index place, const Model& model, const State& state) {
  const Clamp* clamp = rod.clamp_at(place);
  return clamp == nullptr ? initial_tangent_angle(rod, place, model)
                          : tangent_angle(*clamp, model, state);
}

std::vector<HeldNode> held_nodes_at(const Scenario& scenario, double time) {
  const Model model = build_model(scenario.scene());
  State state;
  state.time = time;
  return held_nodes(scenario.scene(), model, state);
}

}  // namespace

std::vector<HeldNode> held_nodes(const scenario::Scene& scene, const Model& model,
                                 const State& state) {
  std::vector<HeldNode> result;
  for (const scenario::Support& support : scene.supports) {
    if (!support.holds()) continue;
    const RodLayout& rod = model.rod(support.rod);
    for (const Index place : nodes_at(support.at, rod)) {
      HeldNode& held = result.emplace_back();
      held.rod = rod.name;
      held.node = rod.nodes[at(place)];
      held.components = held_components(support, model.dimension);
      if (support.clamp) held.tangent_angle = clamp_angle(rod, place, model, state);
    }
  }
  return result;
}

void bind_held_nodes(py::module_& module) {
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

}  // namespace der::python
