#include <cstdlib>
#include <string>
#include <string_view>

#include "bindings.hpp"

namespace der::python {

namespace {

// `(self, n=1)` of `(self: object, n: int = 1)`: inspect reads no types in the texts of compiled
// functions; they are in the stub. Stops behind the bracket that closes.
std::string without_types(std::string_view parameters) {
  std::string bare;
  int depth = 0;
  bool in_type = false;
  for (const char c : parameters) {
    depth += (c == '(' || c == '[') - (c == ')' || c == ']');
    if (depth == 0 || (depth == 1 && (c == ',' || c == '='))) in_type = false;
    if (depth == 1 && c == ':') in_type = true;
    if (!in_type && (c != ' ' || bare.back() == ',')) bare += c;
    if (depth == 0) break;
  }
  return bare;
}

// Brings the text of a function into the form that Python reads a signature from.
void show_signature(PyObject* function) {
  if (Py_TYPE(function) == &PyStaticMethod_Type) {
    show_signature(py::reinterpret_borrow<py::object>(function).attr("__func__").ptr());
    return;
  }
  if (PyInstanceMethod_Check(function)) function = PyInstanceMethod_Function(function);
  if (!PyCFunction_Check(function)) return;
  PyObject* self = PyCFunction_GET_SELF(function);
  if (self == nullptr || py::detail::function_record_ptr_from_PyObject(self) == nullptr) return;
  PyMethodDef& definition = *reinterpret_cast<PyCFunctionObject*>(function)->m_ml;
  if (definition.ml_doc == nullptr) return;
  const std::string_view text = definition.ml_doc;
  const std::string_view name = definition.ml_name;
  const std::string_view line = text.substr(0, text.find('\n'));
  if (line.substr(0, name.size() + 1) != std::string(name) + "(") return;
  if (line.find(") -> ") == std::string_view::npos) return;  // brought into it already
  std::string shown(name);
  shown += without_types(line.substr(name.size())) + "\n--\n\n";
  const std::size_t start = text.find_first_not_of('\n', line.size());
  if (start != std::string_view::npos) shown += text.substr(start);
  std::free(const_cast<char*>(definition.ml_doc));  // pybind11 frees what replaces it
  definition.ml_doc = PYBIND11_COMPAT_STRDUP(shown.c_str());
}

}  // namespace

void show_signatures(const py::module_& module) {
  for (const auto& [name, value] : module.attr("__dict__").cast<py::dict>()) {
    show_signature(value.ptr());
    if (PyType_Check(value.ptr())) {
      for (const py::handle member : value.attr("__dict__").attr("values")())
        show_signature(member.ptr());
    }
  }
}

}  // namespace der::python
