#pragma once

#include <pybind11/pybind11.h>

#include "der/model/model.hpp"

namespace der::python {

namespace py = pybind11;

/// What programs can set: by name, the unit of each component.
inline py::dict settable_names(const Model& model) {
  py::dict all;
  for (const NamedControl& control : model.named) {
    py::dict units;
    for (const ControlComponent& component : control.components) {
      units[py::str(component.name)] = component.unit;
    }
    all[py::str(control.name)] = units;
  }
  return all;
}

}  // namespace der::python
