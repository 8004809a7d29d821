#include "force_functions.hpp"

#include <algorithm>
#include <string>

#include "arrays.hpp"

namespace der::python {
namespace {

using Contiguous = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::string shape_text(const py::array& array) {
  return py::str(py::tuple(array.attr("shape"))).cast<std::string>();
}

Eigen::Map<const Vector> as_nodal_force(const Contiguous& force, const py::function& function,
                                        const Model& model) {
  const bool fits =
      force.ndim() == 2 && force.shape(0) == model.num_nodes && force.shape(1) == model.dimension;
  if (!fits) {
    throw py::value_error("the force function " + py::repr(function).cast<std::string>() +
                          " returned an array of shape " + shape_text(force) +
                          "; (nodes, dim) = (" + std::to_string(model.num_nodes) + ", " +
                          std::to_string(model.dimension) + ") is needed");
  }
  return {force.data(), model.dofs.num_positions()};
}

}  // namespace

void ForceFunctions::add(py::function function) { functions_.push_back(std::move(function)); }

void ForceFunctions::remove(const py::object& function) {
  const auto found = std::find_if(functions_.begin(), functions_.end(),
                                  [&](const py::function& known) { return known.equal(function); });
  if (found == functions_.end()) {
    throw py::value_error("this force function was never added: " +
                          py::repr(function).cast<std::string>());
  }
  functions_.erase(found);
}

void ForceFunctions::apply(const Model& model, State& state, py::handle owner) {
  if (functions_.empty()) return;
  const Array positions = live_view(state.positions, model.num_nodes, model.dimension, owner);
  const Array velocities = live_view(state.velocities, model.num_nodes, model.dimension, owner);
  sum_.setZero(model.num_dofs());
  // A copy, because a function may add or remove functions.
  const std::vector<py::function> functions = functions_;
  for (const py::function& function : functions) {
    const py::object returned = function(state.time, positions, velocities);
    const auto force = Contiguous::ensure(returned);
    if (!force) {
      PyErr_Clear();
      throw py::value_error("the force function " + py::repr(function).cast<std::string>() +
                            " returned no array of numbers but " +
                            py::repr(returned).cast<std::string>());
    }
    sum_.head(model.dofs.num_positions()) += as_nodal_force(force, function, model);
  }
  if (!sum_.allFinite()) {
    throw py::value_error("a force function returned a value that is not finite at t = " +
                          py::str(py::float_(state.time)).cast<std::string>() + " s");
  }
  without_ = state.extra_force;
  state.extra_force += sum_;
  applied_ = true;
}

void ForceFunctions::take_off(State& state) noexcept {
  if (applied_) std::copy_n(without_.data(), without_.size(), state.extra_force.data());
  applied_ = false;
}

int ForceFunctions::traverse(visitproc visit, void* argument) const {
  for (const py::function& function : functions_) {
    if (const int result = visit(function.ptr(), argument)) return result;
  }
  return 0;
}

}  // namespace der::python
