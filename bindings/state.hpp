#pragma once

#include <vector>

#include "der/model/control_names.hpp"
#include "der/model/state.hpp"

namespace der::python {

/// A saved state, with the numbers that give its arrays their shapes and the names of what it sets.
struct SavedState {
  State state;
  Index num_nodes = 0;
  Index dimension = 2;
  std::vector<ControlName> controls{};
};

/// A state of a model to save.
SavedState saved_state(const Model& model, const State& state);

}  // namespace der::python
