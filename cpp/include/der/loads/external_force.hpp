#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// Sets `force` [N] to everything that does not depend on the motion: weight, dead loads, tables at
/// the time of `controls`, and `extra` set from outside.
void external_force(const Model& model, const Vector& controls, const Vector& extra, Vector& force);

}  // namespace der
