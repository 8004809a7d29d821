#include "der/model/model.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "der/building/builder.hpp"
#include "der/core/index.hpp"
#include "der/model/location.hpp"
#include "der/scenario/reader.hpp"
#include "der/scenario/scenario.hpp"
#include "der/supports/axial_spring.hpp"

namespace der::python {
namespace {

/// A place that a spring holds, for drawings.
struct SpringSupport {
  std::string rod;
  std::vector<Index> nodes;
  std::vector<double> weights;
  std::vector<double> stiffness;
  double rotational_stiffness = 0.0;
};

std::vector<SpringSupport> springs(const Scenario& scenario) {
  const Model model = build_model(scenario.scene());
  std::vector<SpringSupport> result;
  for (const scenario::Support& support : scenario.scene().supports) {
    if (!support.spring) continue;
    const RodMesh& rod = model.rod(support.rod);
    SpringSupport& spring = result.emplace_back();
    spring.rod = rod.name;
    spring.stiffness = support.spring->stiffness;
    if (spring.stiffness.empty()) spring.stiffness.assign(to_size(model.dimension), 0.0);
    for (const double k : support.spring->rotational_stiffness) {
      spring.rotational_stiffness = std::max(spring.rotational_stiffness, k);
    }
    for (const auto& [place, weight] : node_weights(rod, arc_length_of(support.at, rod), model)) {
      spring.nodes.push_back(rod.node(place));
      spring.weights.push_back(weight);
    }
  }
  return result;
}

std::vector<std::array<Index, 2>> axial_springs(const Scenario& scenario) {
  const scenario::Scene& scene = scenario.scene();
  const Model model = build_model(scene);
  std::vector<std::array<Index, 2>> ends;
  for (const auto& spring : scene.springs) ends.push_back(nodes_of(spring, scene, model));
  return ends;
}

std::vector<Index> hinges(const Scenario& scenario) {
  const Model model = build_model(scenario.scene());
  std::vector<Index> nodes;
  for (const scenario::Joint& joint : scenario.scene().joints) {
    if (joint.kind != scenario::JointKind::Rigid) nodes.push_back(node_of(joint, model));
  }
  return nodes;
}

template <class T>
py::array_t<T> to_array(const std::vector<T>& values) {
  return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}

void bind_rod(py::module_& module) {
  py::class_<RodMesh>(module, "Rod", "Where a rod is in the model, and its measures.")
      .def_readonly("name", &RodMesh::name, "Name in the scene.")
      .def_property_readonly(
          "nodes", [](const RodMesh& rod) { return to_array(rod.nodes); },
          "Row numbers of the rod's nodes in `positions`, in the order of the arc length.")
      .def_property_readonly(
          "arc_lengths", [](const RodMesh& rod) { return to_array(rod.arc_length); },
          "Rest arc length of each node [m].")
      .def_readonly("closed", &RodMesh::closed, "Whether it is a ring.")
      .def_property_readonly(
          "line_nodes",
          [](const RodMesh& rod) {
            std::vector<Index> nodes = rod.nodes;
            if (rod.closed) nodes.push_back(nodes.front());
            return to_array(nodes);
          },
          "Row numbers of the nodes along its line: those of a ring come back to the first one.")
      .def_property_readonly(
          "line_arc_lengths",
          [](const RodMesh& rod) {
            std::vector<double> places = rod.arc_length;
            if (rod.closed) places.push_back(rod.rest_length());
            return to_array(places);
          },
          "Rest arc lengths [m] of these, one more than the rod has edges.")
      .def_property_readonly("length", &RodMesh::rest_length, "Rest length [m].")
      .def_property_readonly(
          "rest_turning_angles",
          [](const RodMesh& rod) { return to_array(rod.rest_turning_angle); },
          "Natural turning angle at each node [rad]; 0 at the ends.")
      .def_property_readonly(
          "curvature",
          [](const RodMesh& rod) {
            return rod.curvature == scenario::CurvatureMeasure::Angle ? "angle" : "tangent";
          },
          "Curvature measure: angle or tangent.")
      .def_readonly("EA", &RodMesh::EA, "Axial stiffness [N].")
      .def_readonly("EI", &RodMesh::EI, "Bending stiffness [N m^2].")
      .def_readonly("radius", &RodMesh::draw_radius,
                    "Half the height of the section [m]; 0 where only stiffnesses are given.")
      .def_property_readonly(
          "sphere_radii", [](const RodMesh& rod) { return to_array(rod.sphere_radius); },
          "Radius of the sphere on each node [m]; 0 where there is none.")
      .def("__repr__", [](const RodMesh& rod) {
        return py::str("<der.Rod {!r}: {} nodes, length {:.6g} m>")
            .format(rod.name, rod.nodes.size(), rod.rest_length());
      });
}

void bind_spring(py::module_& module) {
  py::class_<SpringSupport>(module, "SpringSupport",
                            "A place that a spring of the scene holds: the weighted sum of nodes.")
      .def_readonly("rod", &SpringSupport::rod, "Name of the rod.")
      .def_property_readonly(
          "nodes", [](const SpringSupport& spring) { return to_array(spring.nodes); },
          "Row numbers in `positions` of the nodes whose weighted sum is the place.")
      .def_property_readonly(
          "weights", [](const SpringSupport& spring) { return to_array(spring.weights); },
          "Weight of each of these nodes; their sum is 1.")
      .def_readonly("stiffness", &SpringSupport::stiffness,
                    "Stiffness along each axis [N/m]; 0 where the spring does not pull.")
      .def_readonly("rotational_stiffness", &SpringSupport::rotational_stiffness,
                    "Stiffness against turning [N m/rad], the largest in space; 0 without.")
      .def("__repr__", [](const SpringSupport& spring) {
        return py::str("<der.SpringSupport on {!r}: {} N/m, {:.6g} N m/rad>")
            .format(spring.rod, spring.stiffness, spring.rotational_stiffness);
      });
  module.def("springs", &springs, py::arg("scenario"), "Return every spring support of the scene.");
  module.def("axial_springs", &axial_springs, py::arg("scenario"),
             "Return the row numbers in `positions` of both ends of each spring between joints.");
  module.def("hinges", &hinges, py::arg("scenario"),
             "Return the row numbers of all hinges in `positions`.");
}

}  // namespace

void bind_model(py::module_& module) {
  bind_rod(module);
  bind_spring(module);
  py::class_<Model>(module, "Model", "The data that stay constant in a run.")
      .def(py::init([](const Scenario& scenario) { return build_model(scenario.scene()); }),
           py::arg("scenario"), "Raises SceneError or DerError where no model can be built.")
      .def_readonly("name", &Model::name, "Name of the model, such as planar.")
      .def_readonly("reason", &Model::reason, "Why this model was taken.")
      .def_readonly("dimension", &Model::dimension, "Components of a position: 2 or 3.")
      .def_property_readonly(
          "is_actuated", [](const Model& model) { return model.natural_strain.is_actuated(); },
          "Whether actuations change the rest shape.")
      .def_readonly("num_nodes", &Model::num_nodes, "Number of nodes of all rods.")
      .def_property_readonly("num_dofs", &Model::num_dofs,
                             "Degrees of freedom, held ones included.")
      .def_property_readonly("num_free", &Model::num_free,
                             "Degrees of freedom that are solved for.")
      .def_property_readonly(
          "rods", [](const Model& model) { return model.rods; }, "The rods, in the scene's order.")
      .def_property_readonly(
          "initial_positions",
          [](const py::object& self) {
            const auto& model = self.cast<const Model&>();
            return read_only_view(model.initial_positions, model.num_nodes, model.dimension, self);
          },
          "Node positions as drawn [m], shape (nodes, dim), read-only.")
      .def("__repr__", [](const Model& model) {
        return py::str("<der.Model {}: {} nodes, {} free of {} degrees of freedom; {}>")
            .format(model.name, model.num_nodes, model.num_free(), model.num_dofs(), model.reason);
      });
}

}  // namespace der::python
