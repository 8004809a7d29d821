#include "bindings.hpp"
#include "der/version.hpp"

PYBIND11_MODULE(_core, module) {
  namespace bindings = der::python;
  module.doc() = "The C++ engine of der. Use the package `der`, which re-exports what is public.";
  module.attr("__version__") = der::version;
  bindings::bind_errors(module);
  bindings::bind_quantities(module);
  bindings::bind_scenario(module);
  bindings::bind_model(module);
  bindings::bind_replay(module);
  bindings::bind_state(module);
  bindings::bind_recording(module);
  bindings::bind_saved_run(module);
  bindings::bind_simulation(module);
  bindings::bind_batch(module);
  bindings::bind_steppers(module);
  bindings::bind_loops(module);
  bindings::bind_unanswered_signals(module);
  bindings::bind_progress(module);
  bindings::show_signatures(module);
}
