#pragma once

#include <pybind11/pybind11.h>

#include "der/output/flush_timer.hpp"

namespace der::python {

namespace py = pybind11;

/// Lets a long loop that runs without the interpreter's lock (GIL) notice Ctrl-C, and report how
/// far it is. `beat()` costs next to nothing: only once per interval it takes the lock.
class Heartbeat {
 public:
  /// `tick()` is called, with the lock held, at every beat that takes the lock.
  template <class Tick>
  void beat(Tick&& tick) {
    if (!pacer_.due()) return;
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    tick();
  }
  void beat() {
    beat([] {});
  }

 private:
  FlushTimer pacer_{FlushTimer::Seconds{0.05}};
};

}  // namespace der::python
