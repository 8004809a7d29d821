#pragma once

#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Finds how many whole turns springs against turning of planar rods are wound up in an
/// equilibrium, which frames do not tell: those with which the forces on the free nodes are in
/// balance. Each turn changes them by a step that is known, so that its number is the nearest whole
/// one. Sets them in `state.followed`.
void find_turns_in_balance(const Model& model, State& state);

}  // namespace der
