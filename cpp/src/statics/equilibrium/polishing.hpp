#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/statics/stiffness.hpp"

namespace der::statics {

/// Takes Newton steps from an equilibrium as long as they become shorter: the residual of the stiff
/// stretching reaches its rounding error before the soft bending is exact. `stiffness` is that
/// `here`, on entry and on exit, and `stability` its stability. Returns false if the steps
/// stay long: then the residual was all rounding error, and hides the shape.
bool polish(const Model& model, const Vector& force, const Stability& stability,
            Stiffness& stiffness, Configuration& here);

}  // namespace der::statics
