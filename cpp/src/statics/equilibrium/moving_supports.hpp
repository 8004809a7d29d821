#pragma once

#include <functional>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "statics/equilibrium/shape.hpp"
#include "statics/equilibrium/static_loads.hpp"

namespace der::statics {

/// Moves a shape to the stable equilibrium near it, as far as one is found.
using Equilibrate = std::function<void(const StaticLoads& loads, Shape& shape)>;

/// Moves the supports to where `loads` has them. Where that would fold or crush the edges beside
/// them at once, they move in steps, and the shape is equilibrated after each one: first in tiny
/// steps that double, so that a rod under compression buckles near its first buckling load and is
/// not compressed into a high buckling mode, whose folds it would keep. The rod follows a clamp
/// that turns by more than a step; in one step its rotation would be known up to whole turns only.
/// `start` are the controls at which the shape was found, if it is not the drawn one: the rotations
/// of clamps in space begin there, those of a plane with the edges beside them.
/// Returns the whole turns of the rods before the clamps turned (`planar_whole_turns`), or nothing
/// if no clamp turns.
std::vector<double> move_supports(const Model& model, const StaticLoads& loads, const Vector& start,
                                  const Equilibrate& equilibrate, Shape& shape);

}  // namespace der::statics
