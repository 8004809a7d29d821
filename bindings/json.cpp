#include "json.hpp"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace der::python {
namespace {

using Json = nlohmann::ordered_json;

py::object owned(PyObject* created) {
  if (created == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(created);
}

py::object text(const std::string& bytes) {
  return owned(
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<py::ssize_t>(bytes.size()), "replace"));
}

py::object list(const Json& items) {
  py::list list(items.size());
  std::size_t place = 0;
  for (const Json& item : items) list[place++] = to_python(item);
  return list;
}

py::object dict(const Json& entries) {
  py::dict dict;
  for (const auto& [key, value] : entries.get_ref<const Json::object_t&>()) {
    dict[text(key)] = to_python(value);
  }
  return dict;
}

}  // namespace

py::object to_python(const Json& json) {
  switch (json.type()) {
    case Json::value_t::object:
      return dict(json);
    case Json::value_t::array:
      return list(json);
    case Json::value_t::string:
      return text(json.get_ref<const std::string&>());
    case Json::value_t::boolean:
      return py::bool_(json.get<bool>());
    case Json::value_t::number_integer:
      return py::int_(json.get<std::int64_t>());
    case Json::value_t::number_unsigned:
      return py::int_(json.get<std::uint64_t>());
    case Json::value_t::number_float:
      // JSON has no other numbers: its texts have null in their place.
      if (!std::isfinite(json.get<double>())) return py::none();
      return py::float_(json.get<double>());
    default:
      return py::none();
  }
}

}  // namespace der::python
