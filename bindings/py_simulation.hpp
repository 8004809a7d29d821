#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "der/output/recorder.hpp"
#include "der/output/run.hpp"
#include "der/simulation.hpp"
#include "force_functions.hpp"

namespace der::python {

namespace py = pybind11;

/// A simulation as Python sees it: the engine, the force functions written in Python, and a guard
/// against two callers at once, which the lock does not prevent since stepping lets go of it.
class PySimulation {
 public:
  /// Without the lock.
  explicit PySimulation(Scenario scenario);

  /// Called after every step of a run, with the lock held; returns false to stop.
  using Callback = std::function<bool()>;
  /// Called now and then while a run goes on, with the lock held.
  using Tick = std::function<void()>;

  /// `self` is the Python object of this simulation.
  void step(std::int64_t count, py::handle self);
  EquilibriumReport equilibrium(py::handle self, bool leave_saddles);
  /// Callbacks and force functions may ask for them, too; Ctrl-C is then answered after them.
  std::vector<Mode> modes(std::int64_t count);
  /// Runs to the end of the scene, to time `until` [s], or until the callback says stop; with
  /// `out`, the run is also written to that folder.
  RunOutcome run(Recorder& recorder, double until, const Callback& callback, const Tick& tick,
                 const std::optional<std::filesystem::path>& out, py::handle self);
  void restore(const State& saved);

  /// As it is to be read: rotations of joints follow what Python has written.
  [[nodiscard]] Simulation& engine() {
    if (!busy_) engine_.follow_writes();
    return engine_;
  }
  [[nodiscard]] ForceFunctions& forces() { return forces_; }
  [[nodiscard]] const ForceFunctions& forces() const { return forces_; }
  /// Issues the warnings that the engine has found.
  void tell_warnings();

 private:
  class Turn;
  class CallOut;
  /// Warns where the integrator has created energy, if that has not been said before.
  void warn_once();
  Simulation engine_;
  ForceFunctions forces_;
  bool busy_ = false;
  bool calls_out_ = false;  // to Python, while the engine waits
  bool warned_ = false;
};

}  // namespace der::python
