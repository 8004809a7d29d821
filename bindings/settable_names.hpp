#pragma once

#include <pybind11/pybind11.h>

#include "der/model/model.hpp"

namespace der::python {

namespace py = pybind11;

/// The names that programs can set, each with the unit of its components.
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
