#pragma once

#include <pybind11/pybind11.h>

#include <exception>

namespace der::python {

/// The Python exception of an error of the engine: an instance of its class in der/errors.py. An
/// exception that is not a der::Error is thrown on.
pybind11::object to_python(std::exception_ptr pointer);

}  // namespace der::python
