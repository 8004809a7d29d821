#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// Sets `force` [N] to everything that does not depend on the motion: weight and dead loads at the
/// load factor, tables at the time of the controls, and `extra` set from outside.
void external_force(const Model& model, const Configuration& here, const Vector& extra,
                    Vector& force);

}  // namespace der
