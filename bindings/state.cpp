#include "state.hpp"

#include <pybind11/stl.h>

#include <cctype>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"

namespace der::python {
namespace {

/// Version of the layout of a dumped state; another one is refused.
constexpr int kVersion = 1;
constexpr const char* kKind = "der.State";

Array to_array(const Vector& vector) { return Array(vector.size(), vector.data()); }

[[noreturn]] void refuse(const std::string& why) {
  throw py::value_error("this is no saved state of this version of der: " + why +
                        ". Save it anew with save_state");
}

Vector to_vector(const py::handle& value) {
  const auto array = py::array_t<double, py::array::c_style>::ensure(value);
  if (!array || !py::isinstance<Array>(value) || array.ndim() != 1) {
    PyErr_Clear();
    refuse("a vector must be an array of doubles of one dimension");
  }
  return Eigen::Map<const Vector>(array.data(), array.size());
}

// Both ways name every part of a state by a structured binding: one more part does not compile
// until it is saved too.

py::tuple dump(const SavedState& saved) {
  const auto& [time, step, positions, velocities, extra_force, accelerations, last_step, history,
               next_step, last_error, work, audit, ramps, turns] = saved.state;
  py::list remembered;
  for (const Vector& vector : history) remembered.append(to_array(vector));
  py::list moved;
  for (const auto& [control, start, end, from, to] : ramps) {
    moved.append(py::make_tuple(control, start, end, from, to));
  }
  return py::make_tuple(kKind, kVersion, saved.dimension, time, step, to_array(positions),
                        to_array(velocities), to_array(extra_force), to_array(accelerations),
                        last_step, remembered, next_step, last_error, work.start, work.loads,
                        work.supports, work.drag, work.solver, audit.exchanged, audit.created,
                        audit.written, audit.folded_from, audit.folded_node, audit.unreliable_from,
                        moved, to_array(turns));
}

SavedState read(const py::tuple& dumped) {
  SavedState saved;
  auto& [time, step, positions, velocities, extra_force, accelerations, last_step, history,
         next_step, last_error, work, audit, ramps, turns] = saved.state;
  std::size_t next = 2;
  const auto take = [&] { return dumped[next++]; };
  const auto number = [&] { return take().cast<double>(); };
  saved.dimension = take().cast<Index>();
  time = number();
  step = take().cast<std::int64_t>();
  for (Vector* vector : {&positions, &velocities, &extra_force, &accelerations}) {
    *vector = to_vector(take());
  }
  last_step = number();
  for (const py::handle& vector : take().cast<py::list>()) history.push_back(to_vector(vector));
  next_step = number();
  last_error = number();
  for (double* part : {&work.start, &work.loads, &work.supports, &work.drag, &work.solver,
                       &audit.exchanged, &audit.created, &audit.written, &audit.folded_from,
                       &audit.folded_node, &audit.unreliable_from}) {
    *part = number();
  }
  for (const auto& ramp : take().cast<std::vector<py::tuple>>()) {
    if (ramp.size() != 5) refuse("a support that moves has five numbers");
    ramps.push_back({ramp[0].cast<Index>(), ramp[1].cast<double>(), ramp[2].cast<double>(),
                     ramp[3].cast<double>(), ramp[4].cast<double>()});
  }
  turns = to_vector(take());
  return saved;
}

SavedState revive(const py::tuple& dumped) {
  constexpr std::size_t kParts = 26;
  try {
    if (dumped.size() != kParts || dumped[0].cast<std::string>() != kKind) refuse("other content");
    if (dumped[1].cast<int>() != kVersion) refuse("another version");
    SavedState saved = read(dumped);
    const Eigen::Index dofs = saved.state.positions.size();
    if (saved.dimension != 2 || dofs % saved.dimension != 0) refuse("another number of dimensions");
    if (saved.state.velocities.size() != dofs) refuse("as many velocities as positions are needed");
    return saved;
  } catch (const py::cast_error&) {
    refuse("a part of another type");
  }
}

void bind_energies(py::module_& module) {
  py::class_<Energies> energies(module, "Energies", "Energies of a state [J].");
  for (const EnergyTermInfo& row : kEnergyTerms) {
    std::string meaning = std::string(row.meaning) + " [J].";
    meaning.front() = static_cast<char>(std::toupper(meaning.front()));
    energies.def_property_readonly(
        row.name, [term = row.term](const Energies& e) { return e[term]; }, meaning.c_str());
  }
  energies
      .def_property_readonly("elastic", &Energies::elastic,
                             "What is stored in rods and spring supports [J].")
      .def_property_readonly("total", &Energies::total, "The sum of all [J].")
      .def("__repr__", [](const Energies& e) {
        std::string terms;
        for (const EnergyTermInfo& row : kEnergyTerms) {
          terms += (terms.empty() ? "" : ", ") + std::string(row.name) + "=" +
                   py::str("{:.6g}").format(e[row.term]).cast<std::string>();
        }
        return "Energies(" + terms + ") J";
      });
}

}  // namespace

void bind_state(py::module_& module) {
  bind_energies(module);
  py::class_<SavedState>(
      module, "State",
      "A saved state of a simulation: positions, velocities, time, written extra "
      "forces and what the\ntime integrator remembers. It can be pickled; "
      "restoring it goes back bit for bit.")
      .def_property_readonly(
          "time", [](const SavedState& s) { return s.state.time; }, "Time [s].")
      .def_property_readonly(
          "step_count", [](const SavedState& s) { return s.state.step; }, "Steps done.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            const auto& saved = self.cast<const SavedState&>();
            return read_only_view(saved.state.positions, saved.dimension, self);
          },
          "Node positions [m], shape (nodes, dim), read-only.")
      .def_property_readonly(
          "velocities",
          [](const py::object& self) {
            const auto& saved = self.cast<const SavedState&>();
            return read_only_view(saved.state.velocities, saved.dimension, self);
          },
          "Node velocities [m/s], shape (nodes, dim), read-only.")
      .def(py::pickle(&dump, &revive))
      .def("__repr__", [](const SavedState& s) {
        return py::str("<der.State at t = {:.6g} s after {} steps, {} nodes>")
            .format(s.state.time, s.state.step, s.state.positions.size() / s.dimension);
      });
}

}  // namespace der::python
