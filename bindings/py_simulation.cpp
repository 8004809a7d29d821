#include <pybind11/stl.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "der/output/run_folder.hpp"
#include "der/output/start.hpp"
#include "der/output/summary.hpp"
#include "der/scenario/scenario.hpp"
#include "heartbeat.hpp"
#include "py_simulation.hpp"

namespace der::python {

/// The right to change the state: one caller at a time, with the lock held on both ends. It leaves
/// no force function's force behind, whatever happens.
class PySimulation::Turn {
 public:
  explicit Turn(PySimulation& simulation) : simulation_(simulation) {
    if (simulation.busy_) {
      throw std::runtime_error(
          "this simulation is busy: force functions and callbacks must not step or restore it, and "
          "two threads must not share it");
    }
    simulation.busy_ = true;
  }
  ~Turn() {
    simulation_.forces_.take_off(simulation_.engine_.state());
    simulation_.busy_ = false;
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  PySimulation& simulation_;
};

/// The time of a call of a function written in Python, with the lock held: the engine is at rest,
/// and what changes nothing may use it.
class PySimulation::CallOut {
 public:
  explicit CallOut(PySimulation& simulation) : simulation_(simulation) {
    simulation.calls_out_ = true;
  }
  ~CallOut() { simulation_.calls_out_ = false; }
  CallOut(const CallOut&) = delete;
  CallOut& operator=(const CallOut&) = delete;

 private:
  PySimulation& simulation_;
};

PySimulation::PySimulation(Scenario scenario) : engine_(std::move(scenario)) {
  Heartbeat heartbeat;
  apply_start(engine_, [&] { heartbeat.beat(); });
}

void PySimulation::step(std::int64_t count, py::handle self) {
  const Turn turn(*this);
  {
    const py::gil_scoped_release unlocked;
    Heartbeat heartbeat;
    for (std::int64_t i = 0; i < count; ++i) {
      if (!forces_.empty()) {
        const py::gil_scoped_acquire lock;
        const CallOut call(*this);
        forces_.apply(engine_.model(), engine_.state(), self);
      }
      engine_.step();
      forces_.take_off(engine_.state());
      if (count > 1) heartbeat.beat();
    }
  }
  warn_once();
  tell_warnings();
}

void PySimulation::tell_warnings() {
  if (!engine_.has_warnings()) return;
  py::module_::import("der.errors").attr("warn")(py::cast(engine_.take_warnings()));
}

void PySimulation::warn_once() {
  if (warned_ || engine_.state().audit.unreliable_from < 0.0) return;
  warned_ = true;
  const py::object category = py::module_::import("der.errors").attr("UnreliableResultWarning");
  const std::string text = created_energy_warning(engine_);
  if (PyErr_WarnEx(category.ptr(), text.c_str(), 1) < 0) throw py::error_already_set();
}

EquilibriumReport PySimulation::equilibrium(py::handle self, bool leave_saddles) {
  const Turn turn(*this);
  {
    const CallOut call(*this);
    forces_.apply(engine_.model(), engine_.state(), self);
  }
  EquilibriumReport report;
  {
    const py::gil_scoped_release unlocked;
    Heartbeat heartbeat;
    report = engine_.equilibrium(leave_saddles, [&] { heartbeat.beat(); });
  }
  tell_warnings();
  return report;
}

std::vector<Mode> PySimulation::modes(std::int64_t count) {
  // There are no more of them than degrees of freedom.
  const auto wanted = static_cast<int>(std::min<std::int64_t>(count, engine_.model().num_dofs()));
  if (calls_out_) return engine_.modes(wanted);
  const Turn turn(*this);
  const py::gil_scoped_release unlocked;
  Heartbeat heartbeat;
  return engine_.modes(wanted, [&] { heartbeat.beat(); });
}

RunOutcome PySimulation::run(Recorder& recorder, double until, const Callback& callback,
                             const Tick& tick, const std::optional<std::filesystem::path>& out,
                             py::handle self) {
  const Turn turn(*this);
  State& state = engine_.state();
  const auto apply_forces = [&] {
    if (forces_.empty()) return;
    const py::gil_scoped_acquire lock;
    const CallOut call(*this);
    forces_.apply(engine_.model(), state, self);
  };
  // Half a step of slack: the times of a run are sums of steps, with their rounding.
  const double stop_at = until - 0.5 * engine_.plan().step;
  engine_.set_horizon(std::min(until, engine_.scenario().scene().time.duration));
  Heartbeat heartbeat;
  const auto after_step = [&](const Simulation&) {
    forces_.take_off(state);
    heartbeat.beat(tick);
    bool go_on = state.time < stop_at;
    if (callback) {
      const py::gil_scoped_acquire lock;
      const CallOut call(*this);
      go_on = callback() && go_on;
    }
    if (go_on && !engine_.finished()) apply_forces();
    return go_on;
  };
  const auto beat = [&] { heartbeat.beat(tick); };
  const py::gil_scoped_release unlocked;
  apply_forces();
  return out ? run_in_folder(RunFolder(*out), engine_, recorder, after_step, beat)
             : der::run(engine_, recorder, after_step, beat);
}

void PySimulation::restore(const State& saved) {
  const Turn turn(*this);
  engine_.restore(saved);
}

}  // namespace der::python
