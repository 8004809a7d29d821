// Values that a program sets in place of the tables of a scene.
#include "controls.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "arrays.hpp"
#include "settable_names.hpp"

namespace der::python {
namespace {

[[noreturn]] void refuse(const std::string& name, py::handle value, const char* expected) {
  throw py::type_error(
      py::str("{!r} takes {}, not {!r}").format(name, expected, value).cast<std::string>());
}

double to_number(py::handle value, std::string_view name, const char* expected) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (number == -1.0 && PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    refuse(std::string(name), value, expected);
  }
  return number;
}

void set_components(Simulation& engine, const std::string& name, const py::dict& values,
                    std::optional<double> over) {
  const std::vector<Ramp> before = engine.state().ramps;
  try {
    for (const auto& [component, value] : values) {
      const auto full = name + "." + py::str(component).cast<std::string>();
      engine.set(full, {to_number(value, full, "a number")}, over);
    }
  } catch (...) {  // all of them or none
    engine.state().ramps = before;
    (void)engine.take_warnings();  // of what is not set
    throw;
  }
}

std::vector<double> to_numbers(py::handle values, std::string_view name) {
  constexpr const char* expected = "a number, a list of numbers or a dict of them";
  // A list of what is iterable, and the list or tuple itself without a copy.
  const auto items =
      py::reinterpret_steal<py::object>(PySequence_Fast(values.ptr(), "no sequence"));
  if (PyUnicode_Check(values.ptr())) refuse(std::string(name), values, expected);
  if (!items) {  // a number of NumPy, or nothing of the kind
    PyErr_Clear();
    return {to_number(values, name, expected)};
  }
  const Py_ssize_t count = PySequence_Fast_GET_SIZE(items.ptr());
  std::vector<double> numbers(static_cast<std::size_t>(count));
  for (Py_ssize_t i = 0; i < count; ++i) {
    numbers[static_cast<std::size_t>(i)] =
        to_number(PySequence_Fast_GET_ITEM(items.ptr(), i), name, expected);
  }
  return numbers;
}

void set(PySimulation& simulation, const Text& name, const py::object& value,
         const std::optional<Number>& given_over) {
  Simulation& engine = simulation.engine();
  const std::string_view text = name.value("the name");
  const std::optional<double> over = to_optional(given_over, "over");
  const bool is_number = PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr());
  if (is_number) {
    engine.set(text, {to_number(value, text, "a number")}, over);
  } else if (PyDict_Check(value.ptr())) {
    set_components(engine, std::string(text), value, over);
  } else {
    engine.set(text, to_numbers(value, text), over);
  }
  simulation.tell_warnings();
}

py::object value(PySimulation& simulation, const Text& given_name) {
  const Simulation& engine = simulation.engine();
  const std::string_view name = given_name.value("the name");
  const Simulation::Settable& found = engine.settable(name);
  const std::vector<double> values = engine.value(name);
  if (found.size() == 1) return py::float_(values.front());
  if (found.whole->is_vector) return Array(static_cast<py::ssize_t>(values.size()), values.data());
  py::dict by_component;
  for (std::size_t i = 0; i < values.size(); ++i) {
    by_component[py::str(found.begin[i].name)] = values[i];
  }
  return by_component;
}

std::size_t support_number(const WholeNumber& given) {
  return static_cast<std::size_t>(given.at_least(0, "the number of the support"));
}

void prescribe(PySimulation& simulation, const WholeNumber& given_support,
               const py::args& without_names, const std::optional<Number>& x,
               const std::optional<Number>& y, const std::optional<Number>& z,
               const std::optional<Number>& angle, const std::optional<Number>& twist,
               const py::kwargs& others) {
  const std::size_t support = support_number(given_support);
  Simulation& engine = simulation.engine();
  const std::vector<Ramp> before = engine.state().ramps;
  // These and others are taken for the sake of messages that say what to write.
  if (!without_names.empty()) {
    throw py::type_error(fmt::format(
        "prescribe takes values by the names of components: write prescribe({}, angle=0.1)",
        support));
  }
  for (const auto& other : others) {
    static_cast<void>(engine.prescribed(support, other.first.cast<std::string>()));
  }
  const auto prescribe_one = [&](const char* component, const std::optional<Number>& given) {
    if (given) engine.prescribe(support, component, given->value(component));
  };
  try {
    prescribe_one("x", x);
    prescribe_one("y", y);
    prescribe_one("z", z);
    prescribe_one("angle", angle);
    prescribe_one("twist", twist);
  } catch (...) {  // all of them or none
    engine.state().ramps = before;
    throw;
  }
}

py::dict prescribed(PySimulation& simulation, const WholeNumber& given_support) {
  const std::size_t support = support_number(given_support);
  const Simulation& engine = simulation.engine();
  py::dict values;
  for (const std::string& component : engine.prescribed_components(support)) {
    values[py::str(component)] = engine.prescribed(support, component);
  }
  return values;
}

}  // namespace

void bind_controls(py::class_<PySimulation>& cls) {
  cls.def("set", &set, py::arg("name"), py::arg("value"), py::arg("over") = py::none(),
          "Set a load or the motion of a support that has a name in the scene, in place of its "
          "table.\n\n"
          "`value` is a number, a list with one for each component, or a dict of some components; "
          "`name` may\nname one component, as ``\"wall.x\"``. `names` has all of them with their "
          "units. The value is reached\nevenly, at the end of the next step or after `over` "
          "seconds, and kept until it is set again;\n`equilibrium` and static scenes take it at "
          "once. DerError where it cannot be set, and nothing is then\nchanged; TypeError for what "
          "is no number. Issues a DerWarning, once for each rod, where actuations turn\n"
          "edges by more than 1 rad.")
      .def("value", &value, py::arg("name"),
           "Present value of what has a name: a number if it has one component, otherwise an array "
           "for a vector\nand a dict by component for a support. DerError as `set`.")
      .def_property_readonly(
          "names", [](PySimulation& s) { return settable_names(s.engine().model()); },
          "What `set` can set: by name, the unit of each component, as "
          "``{\"push\": {\"x\": \"N\", \"y\": \"N\"}}``.")
      .def(
          "prescribe", &prescribe, py::arg("support"), py::arg("x") = py::none(),
          py::arg("y") = py::none(), py::arg("z") = py::none(), py::arg("angle") = py::none(),
          py::arg("twist") = py::none(),
          "Move a support, by its number in the scene, in place of the table that it has there.\n\n"
          "`x`, `y`, `z` [m] count from its initial place, `angle` [rad] from the initial "
          "direction, in space\nabout the axis of the clamp's rotation, `twist` [rad] about the "
          "held tangent. They are\nreached as values that are `set`, which takes supports by "
          "their name. The scene has to prescribe\nthem (``prescribe: {angle: 0}``): DerError if "
          "not.")
      .def("prescribed", &prescribed, py::arg("support"),
           "Present values of what a support prescribes, by name: ``x``, ``y``, ``z`` [m], "
           "``angle``,\n``twist`` [rad]; an empty dict if it prescribes nothing. DerError if the "
           "scene has no such support.");
}

}  // namespace der::python
