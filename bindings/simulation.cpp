#include "der/scenario/scenario.hpp"
#include "py_simulation.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "controls.hpp"
#include "der/core/error.hpp"
#include "der/model/momentum.hpp"
#include "der/output/vertex_strain.hpp"
#include "leave_saddles.hpp"
#include "recording.hpp"
#include "state.hpp"

namespace der::python {
namespace {

/// Whether an object has its simulation. The collector may come before pybind11 has laid the object
/// out: of the first one of a type, it allocates a weak reference in between.
bool is_constructed(PyObject* self) {
  const auto* instance = reinterpret_cast<const py::detail::instance*>(self);
  const bool is_laid_out =
      instance->simple_layout || instance->nonsimple.values_and_holders != nullptr;
  return is_laid_out && py::detail::is_holder_constructed(self);
}

/// Lets Python's collector see the force functions, which often refer back to the simulation.
void support_cycle_collection(PyHeapTypeObject* heap_type) {
  PyTypeObject& type = heap_type->ht_type;
  type.tp_flags |= Py_TPFLAGS_HAVE_GC;
  type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) -> int {
    Py_VISIT(Py_TYPE(self));
    if (!is_constructed(self)) return 0;
    return py::cast<PySimulation&>(py::handle(self)).forces().traverse(visit, arg);
  };
  type.tp_clear = [](PyObject* self) -> int {
    if (is_constructed(self)) {
      py::cast<PySimulation&>(py::handle(self)).forces().clear();
    }
    return 0;
  };
}

/// A live view of the nodes' part of one of the state's vectors as a property of the Python object.
template <Vector State::* member>
Array state_view(const py::object& self) {
  Simulation& engine = self.cast<PySimulation&>().engine();
  const Model& model = engine.model();
  return live_view(engine.state().*member, model.num_nodes, model.dimension, self);
}

/// A live view of the sections' part of one of the state's vectors, which stands behind the nodes'.
template <Vector State::* member>
Array section_view(const py::object& self) {
  Simulation& engine = self.cast<PySimulation&>().engine();
  const Model& model = engine.model();
  const Index first = model.dofs.num_positions();
  return Array(py::ssize_t{model.dofs.num_angles()}, (engine.state().*member).data() + first, self);
}

template <Vec3 Momenta::* part>
Array momentum(PySimulation& simulation) {
  const Momenta all = momenta(simulation.engine().model(), simulation.engine().state());
  return Array(py::ssize_t{3}, (all.*part).data());
}

Array present_directors(PySimulation& simulation) {
  const Vector directors = directors_of(simulation.engine().model(), simulation.engine().state());
  Array result({static_cast<py::ssize_t>(directors.size() / 3), py::ssize_t{3}}, directors.data());
  result.attr("setflags")(false);
  return result;
}

py::tuple reaction_vectors(PySimulation& simulation) {
  const Simulation& engine = simulation.engine();
  Reactions reader(engine.scenario().scene(), engine.model());
  const std::vector<Reaction>& reactions = reader.evaluate(engine.model(), engine.state());
  const auto vectors = [&](Vec3 Reaction::* vector) {
    Array table({static_cast<py::ssize_t>(reactions.size()), py::ssize_t{3}});
    for (std::size_t i = 0; i < reactions.size(); ++i) {
      const Vec3& from = reactions[i].*vector;
      std::copy_n(from.data(), 3, table.mutable_data(static_cast<py::ssize_t>(i), 0));
    }
    return table;
  };
  return py::make_tuple(places_of(reactions), vectors(&Reaction::point), vectors(&Reaction::force),
                        vectors(&Reaction::moment));
}

py::tuple actuation_values(PySimulation& simulation) {
  const Simulation& engine = simulation.engine();
  ActuationForces reader(engine.model());
  const std::vector<ActuationForce>& forces = reader.evaluate(engine.model(), engine.state());
  Array table({static_cast<py::ssize_t>(forces.size()), py::ssize_t{2}});
  for (std::size_t i = 0; i < forces.size(); ++i) {
    std::copy_n(forces[i].values.data(), 2, table.mutable_data(static_cast<py::ssize_t>(i), 0));
  }
  return py::make_tuple(stretches_of(forces), table);
}

py::dict probe_values(PySimulation& simulation) {
  const Simulation& engine = simulation.engine();
  py::dict values;
  for (const Probe& probe : make_probes(engine.scenario().scene(), engine.model())) {
    values[py::str(probe.name())] = probe.value(engine.model(), engine.state());
  }
  return values;
}

void restore(PySimulation& simulation, const py::object& given) {
  if (!py::isinstance<SavedState>(given)) {
    throw py::type_error("a state that save_state has returned is needed, got " +
                         py::repr(given).cast<std::string>());
  }
  const auto& saved = given.cast<const SavedState&>();
  try {
    check_control_names(simulation.engine().model(), saved.controls);
    simulation.restore(saved.state);
  } catch (const Error& error) {
    throw py::value_error(error.what());
  }
}

void bind_reports(py::module_& module) {
  py::class_<Counters>(module, "Counters", "Cost of a simulation so far.")
      .def_readonly("steps", &Counters::steps, "Time steps done.")
      .def_readonly("newton_iterations", &Counters::newton_iterations, "Newton iterations done.")
      .def_readonly("retried_steps", &Counters::retried_steps,
                    "Equal steps that had to be done in smaller pieces.")
      .def_readonly("rejected_steps", &Counters::rejected_steps,
                    "Adaptive steps that were too long for the tolerance.")
      .def_readonly("most_pieces", &Counters::most_pieces,
                    "The most pieces that ``step: auto`` has done a step in.")
      .def("__repr__", [](const Counters& c) {
        return py::str("Counters(steps={}, newton_iterations={}, retried_steps={})")
            .format(c.steps, c.newton_iterations, c.retried_steps);
      });
  py::class_<OutOfPlane>(module, "OutOfPlane",
                         "Whether a planar equilibrium is stable against displacement out of its "
                         "plane and twist.")
      .def_readonly("not_tested", &OutOfPlane::not_tested,
                    "Why it was not tested, as a clause; empty if it was.")
      .def_property_readonly(
          "stability", [](const OutOfPlane& r) { return r.name(); },
          "``stable``, ``unstable``, ``neutral``, ``unknown`` as of an equilibrium in its plane, "
          "or "
          "``not_tested``.")
      .def_property_readonly(
          "unstable_directions",
          [](const OutOfPlane& r) { return r.stability.unstable_directions; },
          "Independent directions in which the potential falls.")
      .def_property_readonly(
          "neutral_directions", [](const OutOfPlane& r) { return r.stability.neutral_directions; },
          "Directions in which the potential is flat to rounding.")
      .def_property_readonly(
          "unknown_directions", [](const OutOfPlane& r) { return r.stability.unknown_directions; },
          "Directions of which rounding hides whether the potential rises or falls.")
      .def("__repr__",
           [](const OutOfPlane& r) { return py::str("OutOfPlane({})").format(r.name()); });
  py::class_<EquilibriumReport>(module, "EquilibriumReport",
                                "How a search for an equilibrium ended.")
      .def_readonly("newton_iterations", &EquilibriumReport::newton_iterations,
                    "Newton iterations done.")
      .def_readonly("relaxations", &EquilibriumReport::relaxations,
                    "Pseudo-time steps taken on the way; 0: Newton's method found it directly.")
      .def_readonly("residual", &EquilibriumReport::residual, "Largest unbalanced force [N].")
      .def_readonly("force_scale", &EquilibriumReport::force_scale, "Largest acting force [N].")
      .def_readonly("saddles_left", &EquilibriumReport::saddles_left,
                    "Unstable equilibria that were found on the way and left downhill.")
      .def_readonly("largest_turning_angle", &EquilibriumReport::largest_turning_angle,
                    "Largest turning angle at a node [rad]; far above 1 the mesh is too coarse.")
      .def_readonly(
          "out_of_plane", &EquilibriumReport::out_of_plane,
          "Whether an equilibrium of a planar model would leave its plane; None in space.")
      .def_property_readonly(
          "stability", [](const EquilibriumReport& r) { return r.stability.name(); },
          "``stable``, ``unstable``, ``neutral`` (flat to rounding in some direction), "
          "``unknown`` (rounding hides whether it is stable) or ``not_judged`` (a load has no "
          "potential).")
      .def_property_readonly(
          "unstable_directions",
          [](const EquilibriumReport& r) { return r.stability.unstable_directions; },
          "Independent directions in which the potential falls; 0 for a stable equilibrium.")
      .def_property_readonly(
          "neutral_directions",
          [](const EquilibriumReport& r) { return r.stability.neutral_directions; },
          "Directions in which the potential is flat to rounding.")
      .def_property_readonly(
          "unknown_directions",
          [](const EquilibriumReport& r) { return r.stability.unknown_directions; },
          "Directions of which rounding hides whether the potential rises or falls.")
      .def("__repr__", [](const EquilibriumReport& r) {
        return py::str("EquilibriumReport({}, residual={:.3g} N)")
            .format(r.stability.name(), r.residual);
      });
}

using PySimulationClass = py::class_<PySimulation>;

py::tuple to_columns(const SymmetricMatrix& matrix) {
  const auto indices = [](const std::vector<Index>& list) {
    return py::array_t<Index>(static_cast<py::ssize_t>(list.size()), list.data());
  };
  return py::make_tuple(Array(matrix.values.size(), matrix.values.data()),
                        indices(matrix.pattern.inner), indices(matrix.pattern.outer));
}

void bind_arrays(PySimulationClass& cls) {
  def_writable_view(
      cls, "positions", &state_view<&State::positions>,
      "Node positions [m], shape (nodes, dim): a live, writable view of the engine's memory.\n\n"
      "It follows every step, and stays valid as long as it is referenced. Held components are "
      "put back\nby the next step, to where their supports are then: let these arrive before you "
      "write. Copy it to\nkeep values.");
  def_writable_view(
      cls, "velocities", &state_view<&State::velocities>,
      "Node velocities [m/s], shape (nodes, dim): a live, writable view, as `positions`.");
  def_writable_view(
      cls, "theta", &section_view<&State::positions>,
      "Angles of the sections [rad], shape (edges,), in the order of the rods and their edges: "
      "a live,\nwritable view, as `positions`. Each counts about the tangent from the edge's "
      "reference director,\nwhich is transported in time. Empty but in the model "
      "``spatial``.");
  def_writable_view(
      cls, "spin", &section_view<&State::velocities>,
      "Spins of the sections about their tangents [rad/s], shape (edges,): a live, writable "
      "view, the\nrates of `theta`.");
  def_writable_view(
      cls, "extra_force", &state_view<&State::extra_force>,
      "Forces on the nodes [N], shape (nodes, dim): a live, writable view, zero at the "
      "start.\n\n"
      "A force written here acts, constant within a step, in every step until something else is "
      "written.\nForces of `add_force` come on top of it.");
  cls.def_property_readonly(
         "directors", &present_directors,
         "Director 1 of the section of each edge, a unit vector along its width, shape (edges, "
         "3): a\nread-only copy. Shape (0, 3) but in the model ``spatial``.")
      .def_property_readonly(
          "node_masses",
          [](const py::object& self) {
            const Model& model = self.cast<PySimulation&>().engine().model();
            const py::ssize_t stride = model.dimension * static_cast<py::ssize_t>(sizeof(double));
            Array mass({py::ssize_t{model.num_nodes}}, {stride}, model.mass.lumped.data(), self);
            mass.attr("setflags")(false);
            return mass;
          },
          "Mass lumped on each node [kg], shape (nodes,), read-only.")
      .def_property_readonly("momentum", &momentum<&Momenta::linear>,
                             "Linear momentum of all rods [kg m/s], shape (3,).")
      .def_property_readonly(
          "angular_momentum", &momentum<&Momenta::angular>,
          "Angular momentum of all rods about the origin [kg m^2/s], shape (3,), that of the spin "
          "of sections\nincluded.")
      .def_property_readonly(
          "free_dofs",
          [](PySimulation& s) {
            const std::vector<Index>& free = s.engine().model().dofs.free();
            return py::array_t<Index>(static_cast<py::ssize_t>(free.size()), free.data());
          },
          "Numbers of the degrees of freedom that no support holds, shape (free,), in the order "
          "of\n"
          "`gradient`, `hessian` and `mass`. They are places in `positions.ravel()`; those behind "
          "its end\nare places in `theta`.")
      .def(
          "gradient",
          [](PySimulation& s) {
            const Vector gradient = s.engine().gradient();
            return Array(gradient.size(), gradient.data());
          },
          "Gradient [N] of the potential energy of rods and loads, `extra_force` included, at the\n"
          "present state, shape (free,): zero in an equilibrium.")
      .def(
          "lower_hessian", [](PySimulation& s) { return to_columns(s.engine().hessian()); },
          "Lower triangle of the Hessian [N/m] over the free degrees of freedom, in compressed\n"
          "columns: values, rows, column starts. `hessian` makes a matrix of it.")
      .def(
          "lower_mass", [](PySimulation& s) { return to_columns(s.engine().mass()); },
          "Lower triangle of the mass matrix [kg], as `lower_hessian`. `mass` makes a matrix of "
          "it.");
}

void bind_progress(PySimulationClass& cls) {
  cls.def_property_readonly(
         "time", [](PySimulation& s) { return s.engine().state().time; }, "Simulated time [s].")
      .def_property_readonly(
          "step_count", [](PySimulation& s) { return s.engine().state().step; },
          "Time steps from time 0 to now.")
      .def_property_readonly(
          "total_steps", [](PySimulation& s) { return s.engine().plan().total_steps; },
          "Time steps from time 0 to the scene's duration; 0 with a tolerance: not known.")
      .def_property_readonly(
          "time_step", [](PySimulation& s) { return s.engine().plan().step; },
          "Length of a time step [s]; 0 with a tolerance.")
      .def_property_readonly(
          "finished", [](PySimulation& s) { return s.engine().finished(); },
          "Whether the scene's duration is reached. `step` goes on beyond it.")
      .def_property_readonly(
          "counters", [](PySimulation& s) { return s.engine().counters(); },
          "Cost of the simulation so far.");
}

void bind_facts(PySimulationClass& cls) {
  cls.def_property_readonly(
         "scenario", [](PySimulation& s) { return s.engine().scenario(); },
         "The scenario it was made from.")
      .def_property_readonly(
          "model", [](PySimulation& s) -> const Model& { return s.engine().model(); },
          "Everything that stays constant: the chosen model and why, rods, degrees of freedom.")
      .def_property_readonly(
          "integrator", [](PySimulation& s) { return std::string(s.engine().integrator().name); },
          "Name of the time integrator.")
      .def_property_readonly(
          "linear_solver", [](PySimulation& s) { return std::string(s.engine().linear_solver()); },
          "Name of the linear solver.")
      .def_property_readonly(
          "linear_solver_reason", [](PySimulation& s) { return s.engine().linear_solver_reason(); },
          "Why this linear solver was taken.")
      .def_property_readonly(
          "energies",
          [](PySimulation& s) { return energies(s.engine().model(), s.engine().state()); },
          "Energies of the present state [J].")
      .def("reaction_vectors", &reaction_vectors,
           "Places of the supports (number, rod, arc length [m]), and points [m], forces [N] and "
           "moments [N m]\non the rods there, each of shape (places, 3); `reactions` makes objects "
           "of them.")
      .def("actuation_values", &actuation_values,
           "Actuations (name, rod, length [m], number of values), and the moments [N m] or forces "
           "[N] that\nthey exert on the rods, shape (actuations, 2); `actuation_forces` makes "
           "objects of them.")
      .def_property_readonly("probes", &probe_values,
                             "Present value of each probe of the scene, by name, in its SI unit.");
}

void bind_actions(PySimulationClass& cls) {
  cls.def(
         "step",
         [](const py::object& self, const WholeNumber& n) {
           self.cast<PySimulation&>().step(n.at_least(0, "the number of steps"), self);
         },
         py::arg("n") = 1,
         "Advance by `n` time steps of the scene.\n\n"
         "Other Python threads run meanwhile, and Ctrl-C interrupts between two steps. Raises\n"
         "NotConvergedError or DivergedError; the state is then that of the last good step.")
      .def(
          "equilibrium",
          [](const py::object& self, const std::optional<Truth>& leave_saddles) {
            auto& simulation = self.cast<PySimulation&>();
            return simulation.equilibrium(
                self, leaves_saddles(leave_saddles, simulation.engine().scenario()));
          },
          py::arg("leave_saddles") = py::none(),
          "Move to the static equilibrium near the present state.\n\n"
          "It is found under the loads at the present time, `extra_force` and the functions of\n"
          "`add_force` (evaluated once, at the start) included. Velocities become zero. An "
          "unstable\n"
          "equilibrium is left for a stable one, unless `leave_saddles` is false; if it is None, "
          "the\n"
          "scene decides, whose static analysis may say `stability: any`. Ctrl-C interrupts "
          "between\n"
          "two iterations, and the state is then as before. Raises NotConvergedError.")
      .def(
          "vibration_modes",
          [](PySimulation& simulation, const WholeNumber& count) {
            const std::vector<Mode> modes =
                simulation.modes(count.at_least(1, "the number of modes"));
            const Model& model = simulation.engine().model();
            Array frequencies(static_cast<py::ssize_t>(modes.size()));
            Array growth_rates(static_cast<py::ssize_t>(modes.size()));
            Array shapes({static_cast<py::ssize_t>(modes.size()), py::ssize_t{model.num_nodes},
                          py::ssize_t{model.dimension}});
            for (std::size_t i = 0; i < modes.size(); ++i) {
              const auto k = static_cast<py::ssize_t>(i);
              frequencies.mutable_at(k) = modes[i].frequency;
              growth_rates.mutable_at(k) = modes[i].growth_rate;
              std::copy_n(modes[i].shape.data(), model.dofs.num_positions(),
                          shapes.mutable_data(k, 0, 0));
            }
            return py::make_tuple(frequencies, growth_rates, shapes);
          },
          py::arg("count"),
          "Frequencies [Hz], growth rates [1/s] and shapes of the lowest modes about the present\n"
          "equilibrium; `modes` makes an object of them.")
      .def(
          "add_force",
          [](PySimulation& simulation, py::object function) {
            if (PyCallable_Check(function.ptr()) == 0) {
              throw py::type_error("a force is a function(time, positions, velocities), got " +
                                   py::repr(function).cast<std::string>());
            }
            simulation.forces().add(function);
            return function;
          },
          py::arg("function"),
          "Add a force: function(time, positions, velocities) -> (nodes, dim) array [N].\n\n"
          "It is evaluated once at the start of every step, with live views of the state, and "
          "acts\n"
          "unchanged during that step, on top of `extra_force`. A force that depends on positions\n"
          "or velocities is therefore explicit: a stiff one needs small steps. Returns the\n"
          "function, so that it works as a decorator.")
      .def(
          "remove_force",
          [](PySimulation& simulation, const py::object& function) {
            simulation.forces().remove(function);
          },
          py::arg("function"), "Remove a force that was added. Raises ValueError if it was not.")
      .def(
          "save_state",
          [](PySimulation& simulation) {
            return saved_state(simulation.engine().model(), simulation.engine().save());
          },
          "Return a copy of the state, to go back to with `restore_state`.")
      .def("restore_state", &restore, py::arg("state"),
           "Go back (or forward) to a saved state, bit for bit. Views stay valid.\n\n"
           "The state may come from another simulation of the same rods and supports, one with\n"
           "another time step too: time goes on from that of the state. What `set` can set has to\n"
           "be the same, in the same order. Raises ValueError that says what does not fit.")
      .def("record", &record, py::arg("callback") = py::none(),
           // Spelled as a number that Python can read in the signature.
           py::arg_v("until", std::numeric_limits<double>::infinity(), "1e999"),
           py::arg("tick") = py::none(), py::arg("out") = py::none(),
           "Run from the present state to the end of the scene, to time `until` [s], or until\n"
           "`callback()` returns false after a step. `tick()` is called now and then; `out` is a\n"
           "folder to write the run to. A failure is told by the recording, not raised.\n"
           "`Simulation.run` makes a Result of it.")
      .def("__repr__", [](const py::object& self) {
        // Tracebacks print objects whose constructor has failed, too.
        if (!py::detail::is_holder_constructed(self.ptr())) return py::str("<der.Simulation>");
        const Simulation& engine = self.cast<PySimulation&>().engine();
        return py::str("<der.Simulation of {!r}: {} nodes, t = {:.6g} s, step {} of {}>")
            .format(engine.scenario().scene().title, engine.model().num_nodes, engine.state().time,
                    engine.state().step, engine.plan().total_steps);
      });
}

}  // namespace

void bind_simulation(py::module_& module) {
  bind_reports(module);
  PySimulationClass cls(
      module, "Simulation", py::custom_type_setup(support_cycle_collection),
      "A scenario's model, its state, and the time integrator that advances it.\n\n"
      "One thread at a time may use a simulation.");
  cls.def(py::init<Scenario>(), py::call_guard<py::gil_scoped_release>(), py::arg("scenario"),
          "Raises SceneError or DerError where the scene cannot be simulated.");
  bind_arrays(cls);
  bind_progress(cls);
  bind_facts(cls);
  bind_actions(cls);
  bind_controls(cls);
}

}  // namespace der::python
