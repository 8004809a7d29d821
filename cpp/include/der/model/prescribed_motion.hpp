#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// Moves the held degrees of freedom of `positions` [m] to where the supports have them: at their
/// initial values, displaced by what `controls` say.
void apply_prescribed_motion(const Model& model, const Vector& controls, Vector& positions);

}  // namespace der
