#include "der/core/error.hpp"

#include <utility>

#include "bindings.hpp"

namespace der::python {
namespace {

// The classes live in der/errors.py: plain Python, so that they are documented, typed and
// picklable.
py::object error_class(const char* name) { return py::module_::import("der.errors").attr(name); }

void set_error(const char* name, const Error& error) {
  const py::object type = error_class(name);
  py::set_error(type, type(error.what(), error.status()));
}

void set_scene_error(const SceneError& error) {
  const py::object diagnostic = error_class("Diagnostic");
  py::list diagnostics;
  for (const Diagnostic& d : error.diagnostics()) {
    diagnostics.append(diagnostic(d.line, d.column, d.path, d.message));
  }
  const py::object type = error_class("SceneError");
  py::set_error(type, type(error.what(), diagnostics));
}

void translate(std::exception_ptr pointer) {
  try {
    std::rethrow_exception(std::move(pointer));
  } catch (const SceneError& error) {
    set_scene_error(error);
  } catch (const NotConvergedError& error) {
    set_error("NotConvergedError", error);
  } catch (const DivergedError& error) {
    set_error("DivergedError", error);
  } catch (const Error& error) {
    set_error("DerError", error);
  }
}

}  // namespace

void bind_errors(py::module_&) { py::register_local_exception_translator(translate); }

}  // namespace der::python
