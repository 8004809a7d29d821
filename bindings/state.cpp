#include "state.hpp"

#include <pybind11/stl.h>

#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"

namespace der::python {
namespace {

Array to_array(const Vector& vector) { return Array(vector.size(), vector.data()); }

Vector to_vector(const Array& array) {
  return Eigen::Map<const Vector>(array.data(), array.size());
}

// Both ways name every part of a state by a structured binding: one more part does not compile
// until it is saved too.

py::tuple dump(const SavedState& saved) {
  const auto& [time, step, positions, velocities, extra_force, accelerations, last_step, history,
               next_step, last_error, work, audit, ramps] = saved.state;
  py::list remembered;
  for (const Vector& vector : history) remembered.append(to_array(vector));
  py::list moved;
  for (const auto& [control, start, end, from, to] : ramps) {
    moved.append(py::make_tuple(control, start, end, from, to));
  }
  return py::make_tuple(saved.dimension, time, step, to_array(positions), to_array(velocities),
                        to_array(extra_force), to_array(accelerations), last_step, remembered,
                        next_step, last_error, work.start, work.loads, work.supports, work.drag,
                        work.solver, moved, audit.exchanged, audit.created, audit.written,
                        audit.unreliable_from);
}

SavedState revive(const py::tuple& dumped) {
  SavedState saved;
  auto& [time, step, positions, velocities, extra_force, accelerations, last_step, history,
         next_step, last_error, work, audit, ramps] = saved.state;
  saved.dimension = dumped[0].cast<Index>();
  time = dumped[1].cast<double>();
  step = dumped[2].cast<std::int64_t>();
  positions = to_vector(dumped[3].cast<Array>());
  velocities = to_vector(dumped[4].cast<Array>());
  extra_force = to_vector(dumped[5].cast<Array>());
  accelerations = to_vector(dumped[6].cast<Array>());
  last_step = dumped[7].cast<double>();
  for (const auto& vector : dumped[8].cast<std::vector<Array>>()) {
    history.push_back(to_vector(vector));
  }
  next_step = dumped[9].cast<double>();
  last_error = dumped[10].cast<double>();
  const auto value = [&](std::size_t i) { return dumped[i].cast<double>(); };
  work = {value(11), value(12), value(13), value(14), value(15)};
  for (const auto& ramp : dumped[16].cast<std::vector<py::tuple>>()) {
    ramps.push_back({ramp[0].cast<Index>(), ramp[1].cast<double>(), ramp[2].cast<double>(),
                     ramp[3].cast<double>(), ramp[4].cast<double>()});
  }
  audit = {value(17), value(18), value(19), value(20)};
  return saved;
}

void bind_energies(py::module_& module) {
  py::class_<Energies>(module, "Energies", "Energies of a state [J].")
      .def_readonly("kinetic", &Energies::kinetic, "Kinetic energy [J].")
      .def_readonly("stretch", &Energies::stretch, "Elastic energy of stretching [J].")
      .def_readonly("bend", &Energies::bend, "Elastic energy of bending [J].")
      .def_readonly("spring", &Energies::spring, "Elastic energy of spring supports [J].")
      .def_readonly("gravity", &Energies::gravity,
                    "Potential energy of the weight [J], zero at the origin.")
      .def_property_readonly("elastic", &Energies::elastic,
                             "Stretching, bending and springs together [J].")
      .def_property_readonly("total", &Energies::total, "The sum of all [J].")
      .def("__repr__", [](const Energies& e) {
        return py::str(
                   "Energies(kinetic={:.6g}, stretch={:.6g}, bend={:.6g}, spring={:.6g}, "
                   "gravity={:.6g}) J")
            .format(e.kinetic, e.stretch, e.bend, e.spring, e.gravity);
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
