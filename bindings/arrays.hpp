#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <vector>

#include "der/core/types.hpp"
#include "der/output/actuation_forces.hpp"
#include "der/output/reactions.hpp"

namespace der::python {

namespace py = pybind11;

using Array = py::array_t<double>;

/// A live, writable (rows x columns) array over the head of a vector that `owner` keeps alive.
inline Array live_view(Vector& data, Index rows, Index columns, py::handle owner) {
  return Array({py::ssize_t{rows}, py::ssize_t{columns}}, data.data(), owner);
}

/// Defines a property that is a live, writable view. Nothing can take its place: a setter says to
/// write into it.
template <class Class, class Getter>
void def_writable_view(Class& cls, const char* name, Getter getter, const char* doc) {
  const auto refuse = [name](const py::object& /*self*/, const py::object& /*value*/) {
    throw py::attribute_error(fmt::format(
        "{0} is an array in the engine's memory, in place of which there can be no other: write "
        "into it, as in {0}[...] = values",
        name));
  };
  cls.def_property(name, getter, refuse, doc);
}

/// A read-only (rows x columns) array over the head of a vector that `owner` keeps alive.
inline Array read_only_view(const Vector& data, Index rows, Index columns, py::handle owner) {
  Array view({py::ssize_t{rows}, py::ssize_t{columns}}, data.data(), owner);
  view.attr("setflags")(false);
  return view;
}

/// The places of reactions: number of the support, name of the rod, rest arc length [m].
inline py::list places_of(const std::vector<Reaction>& reactions) {
  py::list places;
  for (const Reaction& reaction : reactions) {
    places.append(py::make_tuple(reaction.support, reaction.rod, reaction.arc_length));
  }
  return places;
}

/// The actuations whose forces are read: name, name of the rod, length [m], number of values.
inline py::list stretches_of(const std::vector<ActuationForce>& forces) {
  py::list stretches;
  for (const ActuationForce& force : forces) {
    stretches.append(py::make_tuple(force.name, force.rod, force.length, force.num_values));
  }
  return stretches;
}

}  // namespace der::python
