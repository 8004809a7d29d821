#pragma once

#include <pybind11/numpy.h>

#include "der/core/types.hpp"

namespace der::python {

namespace py = pybind11;

using Array = py::array_t<double>;

/// A live, writable (rows x columns) array over memory that `owner` keeps alive.
inline Array live_view(Vector& data, Index columns, py::handle owner) {
  return Array({data.size() / columns, Eigen::Index{columns}}, data.data(), owner);
}

/// A read-only (rows x columns) array over memory that `owner` keeps alive.
inline Array read_only_view(const Vector& data, Index columns, py::handle owner) {
  Array view({data.size() / columns, Eigen::Index{columns}}, data.data(), owner);
  view.attr("setflags")(false);
  return view;
}

}  // namespace der::python
