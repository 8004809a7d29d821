#pragma once

#include "der/model/state.hpp"

namespace der::python {

/// A saved state, with the numbers that give its arrays their shapes.
struct SavedState {
  State state;
  Index num_nodes = 0;
  Index dimension = 2;
};

}  // namespace der::python
