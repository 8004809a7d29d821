#include "der/app/progress.hpp"

#include <pybind11/stl.h>

#include <string>

#include "bindings.hpp"

namespace der::python {

void bind_progress(py::module_& module) {
  module.def(
      "progress_line",
      [](double share, std::optional<double> seconds_left, int width) {
        return app::progress_line(share, {}, seconds_left, width);
      },
      py::arg("share"), py::arg("seconds_left"), py::arg("width"),
      "Return the line that `der run` shows, without the details of a run.\n"
      "\n"
      "Parameters\n"
      "----------\n"
      "share\n"
      "    Of the work that is done, from 0 to 1.\n"
      "seconds_left\n"
      "    None: not known yet.\n"
      "width\n"
      "    Columns that the line may have.");
}

}  // namespace der::python
