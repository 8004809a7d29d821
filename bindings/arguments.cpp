#include "arguments.hpp"

#include <fmt/format.h>

#include <limits>

namespace der::python {
namespace {

std::string message(std::string_view what, const std::string& wanted, py::handle given) {
  constexpr std::size_t kShown = 100;
  std::string shown = py::repr(given).cast<std::string>();
  if (shown.size() > kShown) shown = py::str(py::type::of(given)).cast<std::string>();
  return fmt::format("{} must be {}, got {}", what, wanted, shown);
}

std::string whole_number(std::int64_t least) {
  return fmt::format("a whole number of at least {}", least);
}

}  // namespace

std::int64_t WholeNumber::at_least(std::int64_t least, std::string_view what) const {
  // True counts as 1 in Python, but nobody means that.
  const auto number = PyBool_Check(given.ptr())
                          ? py::object()
                          : py::reinterpret_steal<py::object>(PyNumber_Index(given.ptr()));
  if (!number) {
    PyErr_Clear();
    throw py::type_error(message(what, whole_number(least), given));
  }
  int overflow = 0;
  const long long value = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
  if (overflow != 0) {
    throw py::value_error(fmt::format("{} must be {} and at most {}", what, whole_number(least),
                                      std::numeric_limits<std::int64_t>::max()));
  }
  if (value < least) throw py::value_error(message(what, whole_number(least), number));
  return value;
}

double Number::value(std::string_view what) const {
  const double number = PyFloat_AsDouble(given.ptr());
  if (number == -1.0 && PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throw py::type_error(message(what, "a number", given));
  }
  return number;
}

void Text::check(std::string_view what) const {
  if (!PyUnicode_Check(given.ptr())) throw py::type_error(message(what, "a text", given));
}

std::string_view Text::value(std::string_view what) const {
  check(what);
  Py_ssize_t length = 0;
  const char* text = PyUnicode_AsUTF8AndSize(given.ptr(), &length);
  if (text == nullptr) throw py::error_already_set();
  return {text, static_cast<std::size_t>(length)};
}

bool Truth::value(std::string_view what) const {
  if (PyBool_Check(given.ptr())) return given.ptr() == Py_True;
  if (!py::isinstance(given, py::module_::import("numpy").attr("bool_"))) {
    throw py::type_error(message(what, "True or False", given));
  }
  return py::bool_(given);
}

}  // namespace der::python
