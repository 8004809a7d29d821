#include "der/batch/batch.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "der/core/error.hpp"
#include "der/output/summary.hpp"
#include "der/scenario/scenario.hpp"
#include "errors.hpp"
#include "leave_saddles.hpp"
#include "settable_names.hpp"
#include "state.hpp"
#include "values.hpp"

namespace der::python {
namespace {

/// Takes the lock and looks for Ctrl-C.
void look_for_signals() {
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

std::size_t member_number(const WholeNumber& given) {
  return static_cast<std::size_t>(given.at_least(0, "the number of the member"));
}

std::vector<Variation> to_variations(const py::dict& vary) {
  std::vector<Variation> variations;
  for (const auto& [key, values] : vary) {
    Variation variation{key.cast<std::string>(), {}};
    for (const py::handle& value : values) {
      variation.values.push_back(to_document_value(value, variation.path));
    }
    variations.push_back(std::move(variation));
  }
  return variations;
}

/// A batch as Python sees it: the engine, and a guard against two callers at once, which the lock
/// does not prevent since stepping lets go of it.
class PyBatch {
 public:
  PyBatch(const Scenario& scenario, std::size_t members, int threads, const py::dict& vary)
      : engine_(make(scenario, members, threads, to_variations(vary))) {}

  /// Calls `work(engine)`, as the only one.
  template <class Work>
  auto alone(const Work& work) {
    const Turn turn(busy_);
    return work(engine_);
  }
  /// The same without the interpreter's lock.
  template <class Work>
  auto unlocked(const Work& work) {
    const Turn turn(busy_);
    const py::gil_scoped_release release;
    return work(engine_);
  }

  /// Returns a warning where the integrator has created energy, if that has not been said before.
  std::optional<std::string> step(const WholeNumber& given_count) {
    const std::int64_t count = given_count.at_least(0, "the number of steps");
    unlocked([&](Batch& engine) { engine.step(count, look_for_signals); });
    return new_warning();
  }

  [[nodiscard]] Batch& engine() { return engine_; }

 private:
  class Turn {
   public:
    explicit Turn(bool& busy) : busy_(busy) {
      if (busy_) throw std::runtime_error("this batch is busy: two threads must not share it");
      busy_ = true;
    }
    ~Turn() { busy_ = false; }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    bool& busy_;
  };

  static Batch make(const Scenario& scenario, std::size_t members, int threads,
                    const std::vector<Variation>& variations) {
    const py::gil_scoped_release release;
    return {scenario, members, variations, threads, look_for_signals};
  }

  std::optional<std::string> new_warning() {
    const auto& marks = engine_.unreliable();
    const auto first = std::find(marks.begin(), marks.end(), 1);
    if (warned_ || first == marks.end()) return std::nullopt;
    warned_ = true;
    const auto member = static_cast<std::size_t>(first - marks.begin());
    return "member " + std::to_string(member) + ": " +
           created_energy_warning(engine_.member(member)) +
           " (`unreliable` marks all members of which this is so)";
  }

  Batch engine_;
  bool busy_ = false;
  bool warned_ = false;
};

/// A live, writable array over the part of all rows from entry `first` on.
py::array rows_view(RowMatrix& rows, Index first, const std::vector<py::ssize_t>& shape,
                    const py::object& self) {
  constexpr auto kSize = static_cast<py::ssize_t>(sizeof(double));
  std::vector<py::ssize_t> strides{kSize * rows.cols()};
  py::ssize_t stride = kSize;
  for (std::size_t axis = shape.size() - 1; axis > 0; --axis) {
    strides.insert(strides.begin() + 1, stride);
    stride *= shape[axis];
  }
  return py::array_t<double>(shape, strides, rows.data() + first, self);
}

template <RowMatrix& (Batch::*rows)()>
py::array node_rows(const py::object& self) {
  Batch& engine = self.cast<PyBatch&>().engine();
  const Model& model = engine.model();
  return rows_view((engine.*rows)(), 0,
                   {static_cast<py::ssize_t>(engine.size()), model.num_nodes, model.dimension},
                   self);
}

template <RowMatrix& (Batch::*rows)()>
py::array section_rows(const py::object& self) {
  Batch& engine = self.cast<PyBatch&>().engine();
  const Index first = engine.model().dofs.num_positions();
  return rows_view((engine.*rows)(), first,
                   {static_cast<py::ssize_t>(engine.size()), engine.model().dofs.num_angles()},
                   self);
}

/// A read-only array with one entry a member.
template <class Shown, class Values>
py::array member_view(Values& values, const py::object& self) {
  static_assert(sizeof(Shown) == sizeof(values[0]));
  py::array view(py::dtype::of<Shown>(), {static_cast<py::ssize_t>(values.size())}, {},
                 values.data(), self);
  view.attr("setflags")(false);
  return view;
}

py::array total_steps(PyBatch& batch) {
  const Batch& engine = batch.engine();
  py::array_t<std::int64_t> steps(static_cast<py::ssize_t>(engine.size()));
  for (std::size_t number = 0; number < engine.size(); ++number) {
    steps.mutable_at(static_cast<py::ssize_t>(number)) = engine.member(number).plan().total_steps;
  }
  return steps;
}

py::dict probes(const py::object& self) {
  auto& batch = self.cast<PyBatch&>();
  RowMatrix& values =
      *batch.unlocked([](Batch& engine) { return &engine.probes(look_for_signals); });
  py::dict by_name;
  Index row = 0;
  for (const std::string& name : batch.engine().probe_names()) {
    py::array_t<double> view(py::ssize_t{values.cols()}, values.row(row++).data(), self);
    view.attr("setflags")(false);
    by_name[py::str(name)] = view;
  }
  return by_name;
}

py::list equilibrium(PyBatch& batch, const std::optional<Truth>& given_leave_saddles) {
  const bool leave_saddles =
      leaves_saddles(given_leave_saddles, batch.engine().member(0).scenario());
  const auto reports = batch.unlocked(
      [&](Batch& engine) { return engine.equilibrium(leave_saddles, look_for_signals); });
  py::list all;
  for (const auto& report : reports) all.append(report);
  py::module_::import("der.errors").attr("warn")(py::cast(batch.engine().take_warnings()));
  return all;
}

/// Values for all members as rows, from an array of shape (members, components).
RowMatrix to_rows(const Array& values) {
  RowMatrix rows(values.shape(0), values.shape(1));
  std::copy_n(values.data(), values.size(), rows.data());
  return rows;
}

void set_rows(PyBatch& batch, const std::vector<std::pair<std::string, Array>>& values,
              const std::optional<Number>& given_over) {
  const std::optional<double> over = to_optional(given_over, "over");
  std::vector<Batch::Setting> settings;
  settings.reserve(values.size());
  for (const auto& [name, rows] : values) settings.push_back({name, to_rows(rows)});
  batch.alone([&](Batch& engine) { engine.set(settings, over); });
  py::module_::import("der.errors").attr("warn")(py::cast(batch.engine().take_warnings()));
}

void prescribe_rows(PyBatch& batch, const WholeNumber& given_support,
                    const std::vector<std::pair<std::string, Array>>& values) {
  const auto support =
      static_cast<std::size_t>(given_support.at_least(0, "the number of the support"));
  std::vector<Batch::Prescription> prescriptions;
  prescriptions.reserve(values.size());
  for (const auto& [component, array] : values) {
    prescriptions.push_back({component, Eigen::Map<const Vector>(array.data(), array.size())});
  }
  batch.alone([&](Batch& engine) { engine.prescribe(support, prescriptions); });
}

Array value_rows(PyBatch& batch, const Text& given_name) {
  const std::string name(given_name.value("the name"));
  const RowMatrix rows = batch.alone([&](Batch& engine) { return engine.value(name); });
  return Array({static_cast<py::ssize_t>(rows.rows()), static_cast<py::ssize_t>(rows.cols())},
               rows.data());
}

/// `states` has one for each of the members, or a single one for all; none: each to its start.
void reset(PyBatch& batch, const std::vector<std::size_t>& members,
           const std::vector<const SavedState*>& states) {
  batch.alone([&](Batch& engine) {
    try {
      for (const SavedState* saved : states) check_control_names(engine.model(), saved->controls);
      for (std::size_t i = 0; i < members.size(); ++i) {
        const SavedState* saved = states.empty() ? nullptr : states[states.size() == 1 ? 0 : i];
        engine.reset(members[i], saved == nullptr ? nullptr : &saved->state);
      }
    } catch (const Error& error) {
      throw py::value_error(error.what());
    }
  });
}

py::list failure_rows(PyBatch& batch) {
  return batch.alone([](Batch& engine) {
    py::list rows;
    for (const auto& [member, failure] : engine.failures()) {
      rows.append(py::make_tuple(member, failure.status, failure.time, failure.message,
                                 to_python(failure.error)));
    }
    return rows;
  });
}

using BatchClass = py::class_<PyBatch>;

void bind_arrays(BatchClass& cls) {
  def_writable_view(
      cls, "positions", &node_rows<&Batch::positions>,
      "Node positions [m], shape (members, nodes, dim): a live, writable view.\n\n"
      "It follows every call, and stays valid as long as it is referenced. What is written is "
      "taken into the\nmember's state by the next call. Copy it to keep values.");
  def_writable_view(cls, "velocities", &node_rows<&Batch::velocities>,
                    "Node velocities [m/s], shape (members, nodes, dim): a live, writable "
                    "view, as `positions`.");
  def_writable_view(
      cls, "extra_force", &node_rows<&Batch::extra_force>,
      "Forces on the nodes [N], shape (members, nodes, dim): a live, writable view, zero at "
      "the start.\n\n"
      "A force written here acts, constant within a step, in every step until something else "
      "is written.");
  def_writable_view(cls, "theta", &section_rows<&Batch::positions>,
                    "Angles of the sections [rad], shape (members, edges): a live, "
                    "writable view. Empty but in the model\n``spatial``.");
  def_writable_view(cls, "spin", &section_rows<&Batch::velocities>,
                    "Spins of the sections [rad/s], shape (members, edges): a live, "
                    "writable view, the rates of `theta`.");
  cls.def_property_readonly(
         "time",
         [](const py::object& self) {
           return member_view<double>(self.cast<PyBatch&>().engine().time(), self);
         },
         "Simulated time of each member [s], shape (members,): a live view, read-only.")
      .def_property_readonly(
          "step_count",
          [](const py::object& self) {
            return member_view<std::int64_t>(self.cast<PyBatch&>().engine().step_count(), self);
          },
          "Time steps of each member from time 0 to now, shape (members,): a live view, read-only.")
      .def_property_readonly("total_steps", &total_steps,
                             "Time steps of each member from time 0 to its scene's duration, "
                             "shape (members,); 0 with a tolerance:\nnot known.")
      .def_property_readonly(
          "failed",
          [](const py::object& self) {
            return member_view<bool>(self.cast<PyBatch&>().engine().failed(), self);
          },
          "Which members have failed, shape (members,) of bool: a live view, read-only. They take "
          "no part until\nthey are reset.")
      .def_property_readonly(
          "unreliable",
          [](const py::object& self) {
            return member_view<bool>(self.cast<PyBatch&>().engine().unreliable(), self);
          },
          "Of which members the time integrator has created energy, shape (members,) of bool: a "
          "live view,\nread-only.")
      .def_property_readonly(
          "probes", &probes,
          "Values of the scene's probes, by name, each of shape (members,): live views, "
          "read-only.\n\n"
          "From the first time that they are asked for, every call evaluates them at its end.");
}

void bind_facts(BatchClass& cls) {
  cls.def(
         "__len__", [](PyBatch& b) { return b.engine().size(); }, "Return how many members it has.")
      .def_property_readonly(
          "threads", [](PyBatch& b) { return b.engine().threads(); },
          "How many threads step the members.")
      .def_property_readonly(
          "lanes", [](PyBatch& b) { return b.engine().lanes(); },
          "How many members do their steps together, in the lanes of one register; 1: each alone.")
      .def_property_readonly(
          "model", [](PyBatch& b) -> const Model& { return b.engine().model(); },
          py::return_value_policy::reference_internal,
          "The model of member 0; those of the others have other numbers at most.")
      .def_property_readonly(
          "names", [](PyBatch& b) { return settable_names(b.engine().model()); },
          "What `set` can set: by name, the unit of each component.")
      .def(
          "scenario",
          [](PyBatch& b, const WholeNumber& member) {
            return b.engine().member(member_number(member)).scenario();
          },
          py::arg("member"), "Return the scenario of a member, with its own numbers.")
      .def("failure_rows", &failure_rows,
           "Number, status, time [s] and message of each member that has failed; `failures` makes "
           "objects of them.");
}

void bind_actions(BatchClass& cls) {
  cls.def(
         "advance", &PyBatch::step, py::arg("n"),
         "Advance every member by `n` time steps; `step` tells the failed ones. Returns a warning, "
         "the first time\nthat the integrator of a member has created energy.")
      .def("settle", &equilibrium, py::arg("leave_saddles"),
           "Move every member to its equilibrium; `equilibrium` describes it.")
      .def("set_rows", &set_rows, py::arg("values"), py::arg("over"),
           "Set pairs of a name and an array of shape (members, components); `set` makes them.")
      .def("prescribe_rows", &prescribe_rows, py::arg("support"), py::arg("values"),
           "Prescribe pairs of a component and an array of shape (members,); `prescribe` makes "
           "them.")
      .def("value_rows", &value_rows, py::arg("name"),
           "Present values of a name, shape (members, components); `value` shapes them.")
      .def(
          "save_state",
          [](PyBatch& batch, const WholeNumber& member) {
            const Model& model = batch.engine().model();
            const std::size_t number = member_number(member);
            return saved_state(model,
                               batch.alone([&](Batch& engine) { return engine.save(number); }));
          },
          py::arg("member"),
          "Return a copy of the state of a member, to go back to with `reset`. Simulations of the "
          "same rods take\nit, too (`Simulation.restore_state`).")
      .def("reset_members", &reset, py::arg("members"), py::arg("states"),
           "Bring members to states, or to their starts; `reset` makes lists of what it gets.");
}

}  // namespace

void bind_batch(py::module_& module) {
  BatchClass cls(module, "Batch",
                 "Many simulations of one scene, stepped side by side by several threads.\n\n"
                 "One thread at a time may use a batch.");
  cls.def(py::init<const Scenario&, std::size_t, int, const py::dict&>(), py::arg("scenario"),
          py::arg("members"), py::arg("threads"), py::arg("vary"),
          "Raises SceneError or DerError where a member cannot be simulated.");
  bind_arrays(cls);
  bind_facts(cls);
  bind_actions(cls);
}

}  // namespace der::python
