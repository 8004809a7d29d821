#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/statics/stiffness.hpp"
#include "statics/equilibrium/shape.hpp"
#include "statics/equilibrium/static_loads.hpp"

namespace der::statics {

/// Shapes from which a search for an equilibrium can start again after the one from `start` has
/// failed. Bent along the softest direction to both sides: a load that crushes a straight rod may
/// buckle a bent one. Then with every rod straight, in several directions of the x-y plane: that
/// undoes folds.
std::vector<Shape> restarts(const Model& model, const StaticLoads& loads, Stiffness& stiffness,
                            const Shape& start);

}  // namespace der::statics
