#pragma once

#include <pybind11/pybind11.h>

#include "py_simulation.hpp"

namespace der::python {

/// `Simulation.set`, `value` and `names`, and `prescribe` and `prescribed`.
void bind_controls(py::class_<PySimulation>& cls);

}  // namespace der::python
