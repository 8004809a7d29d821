#pragma once

#include <pybind11/pybind11.h>

#include <vector>

#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der::python {

namespace py = pybind11;

/// Forces that Python functions give: f(time, positions, velocities) -> (nodes x dim) array [N].
/// They act during a step, on top of what the state's `extra_force` holds, and are taken off again
/// after it, so that the state never remembers them.
class ForceFunctions {
 public:
  void add(py::function function);
  /// Throws ValueError if it was never added.
  void remove(const py::object& function);
  [[nodiscard]] bool empty() const { return functions_.empty(); }

  /// Evaluates the functions and adds their sum to `extra_force`. Needs the interpreter's lock; an
  /// error leaves the state as it was. `owner` keeps the state's memory alive.
  void apply(const Model& model, State& state, py::handle owner);
  /// Takes the sum off again, bit for bit; does nothing if there is none. Needs no lock.
  void take_off(State& state) noexcept;

  /// For Python's collector of reference cycles: a function often refers to the simulation.
  int traverse(visitproc visit, void* argument) const;
  void clear() { functions_.clear(); }

 private:
  std::vector<py::function> functions_;
  Vector sum_;
  Vector without_;  // extra_force as it was before `apply`
  bool applied_ = false;
};

}  // namespace der::python
