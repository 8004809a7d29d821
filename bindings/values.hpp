#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "der/scenario/document.hpp"

namespace der::python {

namespace py = pybind11;

/// A Python value as a value of a scene document: None, bool, int, float, str, list, tuple, dict
/// with str keys, and whatever turns into these by `tolist()` (scalars and arrays of NumPy). `path`
/// is where it belongs, such as `rods.beam.nodes`; empty for a whole scene. Throws SceneError with
/// a diagnostic for every part that is none of these, up to a hundred, and for values that are
/// nested without end.
scenario::Value to_document_value(const py::handle& object, const std::string& path);

/// The other way round. An unquoted scalar of a text becomes a number, a truth value or None where
/// it reads as one, else a str.
py::object to_python(const scenario::Value& value);

}  // namespace der::python
