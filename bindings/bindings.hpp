#pragma once

#include <pybind11/pybind11.h>

namespace der::python {

namespace py = pybind11;

// One function for each file of bindings; module.cpp calls them in an order in which every type is
// known before a signature names it.
void bind_errors(py::module_& module);
void bind_quantities(py::module_& module);
void bind_scenario(py::module_& module);
void bind_model(py::module_& module);
void bind_replay(py::module_& module);
void bind_state(py::module_& module);
void bind_recording(py::module_& module);
void bind_saved_run(py::module_& module);
void bind_simulation(py::module_& module);
void bind_batch(py::module_& module);
void bind_steppers(py::module_& module);
void bind_loops(py::module_& module);
void bind_unanswered_signals(py::module_& module);
void bind_progress(py::module_& module);

// Gives all functions of the module signatures that `inspect.signature` and `help` read.
void show_signatures(const py::module_& module);

}  // namespace der::python
