#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace der::python {

namespace py = pybind11;

// Arguments that take any Python object, so that one of another kind gets a message that says what
// to write; pybind11 would list the signatures of C++. `what` names the argument in that message.

/// A whole number, of Python or NumPy.
struct WholeNumber {
  py::object given;
  /// Throws TypeError if it is none, ValueError if it is less, or does not fit.
  [[nodiscard]] std::int64_t at_least(std::int64_t least, std::string_view what) const;
};

/// A number, which may be infinite or nan: the engine refuses these where they do not fit.
struct Number {
  py::object given;
  /// Throws TypeError if it is none.
  [[nodiscard]] double value(std::string_view what) const;
};

inline std::optional<double> to_optional(const std::optional<Number>& given,
                                         std::string_view what) {
  return given ? std::optional(given->value(what)) : std::nullopt;
}

/// A name, or another text.
struct Text {
  py::object given;
  /// Throws TypeError if it is none.
  void check(std::string_view what) const;
  /// Lives as long as `given`. Throws as `check`.
  [[nodiscard]] std::string_view value(std::string_view what) const;
};

/// True or false.
struct Truth {
  py::object given;
  /// Throws TypeError if it is neither.
  [[nodiscard]] bool value(std::string_view what) const;
};

}  // namespace der::python

namespace pybind11::detail {

/// Takes any object.
template <class Argument>
struct any_object_caster {
  bool load(handle source, bool /*convert*/) {
    value.given = reinterpret_borrow<object>(source);
    return true;
  }
  template <class T>
  using cast_op_type = Argument&;
  // The name that pybind11 looks for. NOLINTNEXTLINE(google-explicit-constructor)
  operator Argument&() { return value; }
  Argument value;
};

template <>
struct type_caster<der::python::WholeNumber> : any_object_caster<der::python::WholeNumber> {
  static constexpr auto name = const_name("int");
};
template <>
struct type_caster<der::python::Number> : any_object_caster<der::python::Number> {
  static constexpr auto name = const_name("float");
};
template <>
struct type_caster<der::python::Text> : any_object_caster<der::python::Text> {
  static constexpr auto name = const_name("str");
};
template <>
struct type_caster<der::python::Truth> : any_object_caster<der::python::Truth> {
  static constexpr auto name = const_name("bool");
};

}  // namespace pybind11::detail
