#pragma once

#include <pybind11/numpy.h>

#include "der/core/types.hpp"

namespace der::python {

namespace py = pybind11;

using Array = py::array_t<double>;

/// A live, writable (rows x columns) array over the head of a vector that `owner` keeps alive.
inline Array live_view(Vector& data, Index rows, Index columns, py::handle owner) {
  return Array({py::ssize_t{rows}, py::ssize_t{columns}}, data.data(), owner);
}

/// A read-only (rows x columns) array over the head of a vector that `owner` keeps alive.
inline Array read_only_view(const Vector& data, Index rows, Index columns, py::handle owner) {
  Array view({py::ssize_t{rows}, py::ssize_t{columns}}, data.data(), owner);
  view.attr("setflags")(false);
  return view;
}

}  // namespace der::python
