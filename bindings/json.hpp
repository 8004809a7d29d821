#pragma once

#include <pybind11/pybind11.h>

#include <nlohmann/json_fwd.hpp>

namespace der::python {

namespace py = pybind11;

/// What `json.loads` would make of the text of a JSON value, without the text: dicts in the same
/// order, lists, str, int, float, bool and None. Bytes of a text that are not UTF-8 are replaced.
py::object to_python(const nlohmann::ordered_json& json);

}  // namespace der::python
