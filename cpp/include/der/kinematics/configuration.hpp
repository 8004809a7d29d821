#pragma once

#include "der/core/types.hpp"

namespace der {

/// A point in configuration space, with all that elements read there. `controls` are prepared once
/// for a new point, from the tables at a time and from what the state has followed
/// (`evaluate_controls`), and are then read by every kernel; between the iterations of a solver
/// only the coordinates change.
struct Configuration {
  Vector coordinates;        ///< one entry a degree of freedom: positions [m]
  Vector controls;           ///< values that elements and supports follow besides
  double load_factor = 1.0;  ///< of what the scene varies (model/load_variation.hpp); 1: as written
};

}  // namespace der
