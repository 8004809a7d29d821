#pragma once

#include "der/model/model.hpp"
#include "der/statics/stiffness.hpp"
#include "statics/equilibrium/shape.hpp"
#include "statics/equilibrium/static_loads.hpp"
#include "statics/equilibrium/static_newton.hpp"

namespace der::statics {

/// Dynamic relaxation: damped motion with unit masses from `shape`, at rest, in implicit Euler
/// steps. The momentum carries the structure past shapes at which pseudo-transient continuation
/// ends because a node folds or an edge collapses. Returns whether `shape` is now an equilibrium;
/// if not it stays as it was. Adds the steps tried to `steps`.
bool relax_dynamically(const Model& model, const StaticLoads& loads, StaticNewton& newton,
                       Stiffness& stiffness, Shape& shape, int& steps);

}  // namespace der::statics
