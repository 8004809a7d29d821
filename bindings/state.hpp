#pragma once

#include "der/model/state.hpp"

namespace der::python {

/// A saved state, with the number of components of a position so that arrays get their shape.
struct SavedState {
  State state;
  Index dimension = 2;
};

}  // namespace der::python
