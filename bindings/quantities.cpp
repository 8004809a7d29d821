#include "der/catalog/quantities.hpp"

#include <pybind11/stl.h>

#include <map>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "der/catalog/run_status.hpp"
#include "der/output/datasets.hpp"
#include "der/output/run_arrays.hpp"

namespace der::python {
namespace {

const char* kind_name(QuantityKind kind) {
  switch (kind) {
    case QuantityKind::Position:
      return "position";
    case QuantityKind::Velocity:
      return "velocity";
    case QuantityKind::Tangent:
      return "tangent";
    case QuantityKind::Turn:
      return "turn";
    case QuantityKind::Bend:
      return "bend";
    case QuantityKind::Edge:
      return "edge";
    case QuantityKind::Section:
      return "section";
    case QuantityKind::Natural:
      return "natural";
    case QuantityKind::Ring:
      return "ring";
    case QuantityKind::Support:
      return "support";
    case QuantityKind::Actuation:
      return "actuation";
    case QuantityKind::Joint:
      return "joint";
    case QuantityKind::Spring:
      return "spring";
    case QuantityKind::Energy:
      return "energy";
  }
  return "";
}

std::map<std::string, std::string> array_units() {
  std::map<std::string, std::string> units;
  for (const RunArray& array : run_arrays()) units[array.name] = array.unit;
  return units;
}

std::vector<std::string> path_events() {
  return {event_name(PathEvent::None), event_name(PathEvent::Fold),
          event_name(PathEvent::Bifurcation), event_name(PathEvent::OutOfPlane)};
}

}  // namespace

void bind_quantities(py::module_& module) {
  py::class_<Quantity>(module, "Quantity", "A quantity that probes record.")
      .def_readonly("name", &Quantity::name, "As a probe's `quantity` names it.")
      .def_readonly("unit", &Quantity::unit, "SI unit; empty for a pure number.")
      .def_property_readonly(
          "kind", [](const Quantity& quantity) { return kind_name(quantity.kind); },
          "Where it is known: position, velocity (at nodes), tangent (at any arc length), turn (at "
          "nodes that bend), section "
          "(where "
          "sections bend or twist), bend, edge "
          "(at any arc length, with jumps), ring (of a whole ring), support (of a support), "
          "joint (of a joint), "
          "energy (of a rod or the whole model, at no place).")
      .def_readonly("meaning", &Quantity::meaning, "In words.")
      .def_readonly("is_component", &Quantity::is_component,
                    "Whether it is a component of the position or of the velocity.")
      .def("is_available", &is_available, py::arg("model"), "Whether a model has the quantity.")
      .def("__repr__", [](const Quantity& quantity) {
        return py::str("<der.Quantity {} [{}]: {}>")
            .format(quantity.name, quantity.unit, quantity.meaning);
      });
  module.def("quantities", [] { return quantities(); }, "Every quantity that probes record.");
  module.def("array_units", &array_units,
             "SI unit of every array of a run file, by its name: `positions`, `energies/bend`.");
  module.def("ended_as_asked", &run_status::ended_as_asked, py::arg("status"),
             "Return whether a run of that status is finished, or was stopped by its caller.");
  module.def("path_events", &path_events,
             "Names of the numbers in the array `path/event` of a run file.");
}

}  // namespace der::python
