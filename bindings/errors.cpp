#include "errors.hpp"

#include <utility>

#include "bindings.hpp"
#include "der/core/error.hpp"

namespace der::python {
namespace {

// The classes live in der/errors.py: plain Python, so that they are documented, typed and
// picklable.
py::object error_class(const char* name) { return py::module_::import("der.errors").attr(name); }

py::object make_error(const char* name, const Error& error) {
  return error_class(name)(error.what(), error.status());
}

py::object make_scene_error(const SceneError& error) {
  const py::object diagnostic = error_class("Diagnostic");
  py::list diagnostics;
  for (const Diagnostic& d : error.diagnostics()) {
    diagnostics.append(diagnostic(d.line, d.column, d.path, d.message));
  }
  return error_class("SceneError")(error.what(), diagnostics);
}

void translate(std::exception_ptr pointer) {
  const py::object error = to_python(std::move(pointer));
  py::set_error(py::type::of(error), error);
}

}  // namespace

py::object to_python(std::exception_ptr pointer) {
  try {
    std::rethrow_exception(std::move(pointer));
  } catch (const SceneError& error) {
    return make_scene_error(error);
  } catch (const NotConvergedError& error) {
    return make_error("NotConvergedError", error);
  } catch (const DivergedError& error) {
    return make_error("DivergedError", error);
  } catch (const Error& error) {
    return make_error("DerError", error);
  }
}

void bind_errors(py::module_&) { py::register_local_exception_translator(translate); }

}  // namespace der::python
