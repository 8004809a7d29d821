#pragma once

#include "der/core/types.hpp"

namespace der::statics {

/// A shape of the structure: the coordinates, and what they do not tell.
struct Shape {
  Vector positions;  ///< all degrees of freedom
  Vector followed;   ///< as in the state (model/followed.hpp)
};

}  // namespace der::statics
