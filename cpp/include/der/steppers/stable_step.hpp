#pragma once

#include <string>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// The largest step of the explicit steppers, and what sets it.
struct StableStep {
  double step = 0.0;       ///< [s]; infinite where nothing limits it
  std::string limited_by;  ///< "stretch", "bend", "spring" or "drag"
  Index worst_dof = -1;    ///< full degree of freedom with the fastest motion of that kind
};

/// Bound from the stiffness at `positions`. A mode of frequency w and damping rate g stays bounded
/// under explicit Euler's scheme while dt^2 w^2 + 2 dt g <= 4 (both roots of its characteristic
/// polynomial inside the unit circle), under Verlet's, which takes damping implicitly, while
/// dt w <= 2. w^2 is bounded by Gershgorin's row sums of D^-1/2 K D^-1/2, D a diagonal below the
/// mass, so the step is safe, and on an even chain close to the true limit.
StableStep stable_step(const Model& model, const Vector& positions, bool drag_limits_step);

}  // namespace der
