#include "der/core/loops.hpp"

#include <string>

#include "bindings.hpp"

namespace der::python {

void bind_loops(py::module_& module) {
  module.def(
      "loops", [] { return std::string(name_of(loops())); },
      "Return for which processors the innermost loops that run were compiled: `plain` or `avx2`.\n"
      "\n"
      "The environment variable DER_LOOPS chooses them when the process first needs them.");
}

}  // namespace der::python
