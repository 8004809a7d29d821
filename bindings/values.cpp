#include "values.hpp"

#include <charconv>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "der/core/error.hpp"

namespace der::python {
namespace {

/// Far beyond a rod of a million nodes that is drawn as a polyline; a dict that holds few lists
/// many times over could fill any memory.
constexpr std::size_t kMaxValues = 20'000'000;
/// More diagnostics than these help nobody.
constexpr std::size_t kMaxRefused = 100;

/// The text of a str; none where it holds half of a surrogate pair, which UTF-8 has no form for.
std::optional<std::string> utf8_of(const py::handle& text) {
  Py_ssize_t size = 0;
  const char* bytes = PyUnicode_AsUTF8AndSize(text.ptr(), &size);
  if (bytes) return std::string(bytes, static_cast<std::size_t>(size));
  PyErr_Clear();
  return std::nullopt;
}

class Converter {
 public:
  scenario::Value convert(const py::handle& object, const std::string& path) {
    if (++values_ > kMaxValues) {
      give_up(path, "the scene has more than " + std::to_string(kMaxValues) + " values");
    }
    const Level level(*this);
    if (level_ > scenario::kMaxDepth) {
      give_up(path, "values nested in more than " + std::to_string(scenario::kMaxDepth) +
                        " levels: no scene needs that (does a dict or a list hold itself?)");
    }
    if (object.is_none()) return scenario::make_null();
    if (py::isinstance<py::bool_>(object)) return scenario::make_scalar(object.cast<bool>());
    if (py::isinstance<py::int_>(object)) return whole(object, path);
    if (py::isinstance<py::float_>(object)) return scenario::make_scalar(object.cast<double>());
    if (py::isinstance<py::str>(object)) return text(object, path);
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
  /// One value inside another, for as long as it is converted.
  class Level {
   public:
    explicit Level(Converter& converter) : level_(converter.level_) { ++level_; }
    ~Level() { --level_; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;

   private:
    std::size_t& level_;
  };

  static std::string type_name(const py::handle& object) {
    return py::type::of(object).attr("__name__").cast<std::string>();
  }

  static std::string join(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
  }

  scenario::Value refuse(const std::string& path, const std::string& message) {
    diagnostics_.push_back({0, 0, path, message});
    if (diagnostics_.size() == kMaxRefused) throw_if_refused();
    return scenario::make_null();
  }

  /// Refuses without a look at the rest, which may have no end.
  void give_up(const std::string& path, const std::string& message) {
    diagnostics_.push_back({0, 0, path, message});
    throw_if_refused();
  }

  scenario::Value text(const py::handle& object, const std::string& path) {
    std::optional<std::string> written = utf8_of(object);
    if (written) return scenario::make_scalar(std::move(*written));
    return refuse(path, "the text " + py::repr(object).cast<std::string>() +
                            " holds half of a surrogate pair, which is not a character");
  }

  scenario::Value whole(const py::handle& object, const std::string& path) {
    int overflow = 0;
    const long long value = PyLong_AsLongLongAndOverflow(object.ptr(), &overflow);
    if (overflow != 0) return refuse(path, "a whole number beyond 64 bits; write it as a float");
    return scenario::make_scalar(std::int64_t{value});
  }

  scenario::Value mapping(const py::dict& dict, const std::string& path) {
    scenario::Mapping entries;
    // A copy: what is called for a value (`tolist`) may change the dict.
    const auto copy = py::reinterpret_steal<py::dict>(PyDict_Copy(dict.ptr()));
    for (const auto& [key, value] : copy) {
      if (!py::isinstance<py::str>(key)) {
        refuse(path, "the key " + py::repr(key).cast<std::string>() + " is of type " +
                         type_name(key) + "; keys are texts");
        continue;
      }
      const std::optional<std::string> name = utf8_of(key);
      if (!name) {
        text(key, path);
        continue;
      }
      entries.push_back({*name, convert(value, join(path, *name)), {}});
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
      if (py::isinstance<py::str>(name)) {
        if (const std::optional<std::string> written = utf8_of(name)) return *written;
      }
    }
    return std::to_string(number);
  }

  std::vector<Diagnostic> diagnostics_;
  std::size_t values_ = 0;
  std::size_t level_ = 0;
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
