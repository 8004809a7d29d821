#pragma once

#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Moves `State::followed` to positions that something else than a step or a search has written, in
/// a model without sections. Edges of a planar rod have turned against one another as the shape
/// tells, whole turns included. What the turns of a rod count from is, where it has them, a clamp
/// that does not turn, else a spring against turning, else a clamp that turns: its edge has turned
/// with it. A state that never moved counts from the drawn shape: supports that are elsewhere at
/// time 0 tell nothing about the written one. In space, frames go the shorter way.
void follow_written(const Model& model, State& state);

/// Whether a state tells the turns of its sections no more once a program has written its positions
/// but not their angles: it never moved while clamps are turned, a clamp at rest has been turned by
/// more than a quarter turn since, or an edge is turned too far.
bool lost_angles(const Model& model, const State& state);

/// Moves `State::followed` of a model with sections to positions and angles of sections that a
/// program has written. Angles count from the frames that the shape determines (`lay_frames`), as
/// those of equilibria do: the twist behind the last edge of a chain is then, up to whole turns,
/// what it is before it. In a run over time they count from the frames that moved with the rod,
/// if these tell the shape.
void follow_written_angles(const Model& model, State& state);

/// Counts the angles of a state's sections, which stay where they are, from the frames that its
/// shape determines (`lay_frames`).
void count_angles_from_shape(const Model& model, State& state);

}  // namespace der
