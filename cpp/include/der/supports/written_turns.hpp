#pragma once

#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Moves `State::followed` to positions that something else than a step or a search has written.
/// Edges of a planar rod have turned against one another as the shape tells, whole turns included.
/// What the turns of a rod count from is, where it has them, a clamp that does not turn, else a
/// spring against turning, else a clamp that turns: its edge has turned with it. A state that never
/// moved counts from the drawn shape: supports that are elsewhere at time 0 tell nothing about the
/// written one. In space, frames go the shorter way.
void follow_written(const Model& model, State& state);

}  // namespace der
