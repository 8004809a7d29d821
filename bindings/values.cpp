#include "values.hpp"

#include <charconv>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "der/core/error.hpp"

namespace der::python {
namespace {

class Converter {
 public:
  scenario::Value convert(const py::handle& object, const std::string& path) {
    if (object.is_none()) return scenario::make_null();
    if (py::isinstance<py::bool_>(object)) return scenario::make_scalar(object.cast<bool>());
    if (py::isinstance<py::int_>(object)) return whole(object, path);
    if (py::isinstance<py::float_>(object)) return scenario::make_scalar(object.cast<double>());
    if (py::isinstance<py::str>(object)) return scenario::make_scalar(object.cast<std::string>());
    if (py::isinstance<py::dict>(object)) {
      return mapping(py::reinterpret_borrow<py::dict>(object), path);
    }
    if (py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object)) {
      return sequence(py::reinterpret_borrow<py::sequence>(object), path);
    }
    if (py::hasattr(object, "tolist")) return convert(object.attr("tolist")(), path);
    return refuse(path, "a value of type " + type_name(object) +
                            " cannot stand in a scene; use numbers, texts, lists and dicts");
  }

  void throw_if_refused() const {
    if (!diagnostics_.empty()) throw SceneError("", diagnostics_);
  }

 private:
  static std::string type_name(const py::handle& object) {
    return py::type::of(object).attr("__name__").cast<std::string>();
  }

  static std::string join(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
  }

  scenario::Value refuse(const std::string& path, const std::string& message) {
    diagnostics_.push_back({0, 0, path, message});
    return scenario::make_null();
  }

  scenario::Value whole(const py::handle& object, const std::string& path) {
    int overflow = 0;
    const long long value = PyLong_AsLongLongAndOverflow(object.ptr(), &overflow);
    if (overflow != 0) return refuse(path, "a whole number beyond 64 bits; write it as a float");
    return scenario::make_scalar(std::int64_t{value});
  }

  scenario::Value mapping(const py::dict& dict, const std::string& path) {
    scenario::Mapping entries;
    for (const auto& [key, value] : dict) {
      if (!py::isinstance<py::str>(key)) {
        refuse(path, "the key " + py::repr(key).cast<std::string>() + " is of type " +
                         type_name(key) + "; keys are texts");
        continue;
      }
      const auto name = key.cast<std::string>();
      entries.push_back({name, convert(value, join(path, name)), {}});
    }
    return scenario::make_mapping(std::move(entries));
  }

  scenario::Value sequence(const py::sequence& items, const std::string& path) {
    scenario::Sequence values;
    const std::size_t size = items.size();
    for (std::size_t i = 0; i < size; ++i) {
      const py::object item = items[i];
      values.push_back(convert(item, join(path, item_name(item, i))));
    }
    return scenario::make_sequence(std::move(values));
  }

  /// Key paths call a list item by its `name` where it has one.
  static std::string item_name(const py::object& item, std::size_t number) {
    if (py::isinstance<py::dict>(item)) {
      const py::object name = item.attr("get")("name");
      if (py::isinstance<py::str>(name)) return name.cast<std::string>();
    }
    return std::to_string(number);
  }

  std::vector<Diagnostic> diagnostics_;
};

template <class Number>
bool reads_as(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size();
}

py::object plain_to_python(std::string_view text) {
  if (text == "true" || text == "false") return py::bool_(text == "true");
  if (text == "null" || text == "~" || text.empty()) return py::none();
  // `inf` and `nan`, which from_chars would take, are no numbers in a scene.
  if (text.find_first_not_of("0123456789+-.eE") == std::string_view::npos) {
    const std::string_view digits = text.front() == '+' ? text.substr(1) : text;
    if (std::int64_t whole = 0; reads_as(digits, whole)) return py::int_(whole);
    if (double real = 0.0; reads_as(digits, real)) return py::float_(real);
  }
  return py::str(text.data(), text.size());
}

struct ToPython {
  py::object operator()(std::monostate) const { return py::none(); }
  py::object operator()(const scenario::Plain& plain) const { return plain_to_python(plain.text); }
  py::object operator()(const std::string& text) const { return py::str(text); }
  py::object operator()(bool value) const { return py::bool_(value); }
  py::object operator()(std::int64_t value) const { return py::int_(value); }
  py::object operator()(double value) const { return py::float_(value); }
  py::object operator()(const scenario::Sequence& items) const {
    py::list list;
    for (const scenario::Value& item : items) list.append(to_python(item));
    return list;
  }
  py::object operator()(const scenario::Mapping& entries) const {
    py::dict dict;
    for (const scenario::Entry& entry : entries) dict[py::str(entry.key)] = to_python(entry.value);
    return dict;
  }
};

}  // namespace

scenario::Value to_document_value(const py::handle& object, const std::string& path) {
  Converter converter;
  scenario::Value value = converter.convert(object, path);
  converter.throw_if_refused();
  return value;
}

py::object to_python(const scenario::Value& value) { return std::visit(ToPython{}, value.content); }

}  // namespace der::python
