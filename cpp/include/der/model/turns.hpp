#pragma once

#include "der/core/types.hpp"
#include "der/model/edge.hpp"

namespace der {

struct Model;

/// An edge whose whole turns count, because a spring winds up on it, or a clamp turns it. Positions
/// determine the direction of an edge, but not its number of whole turns, so the state follows it
/// from step to step (`State::turns`).
struct FollowedEdge {
  Edge edge;
  double direction = 0.0;  ///< initial one [rad]
  Index turn = -1;  ///< entry of the controls through which elements see what it has turned by
};

/// Sets `turns` [rad], one for each followed edge of the model, to those at `positions`: counted
/// from the initial directions, and the shorter way from the present `turns`.
void follow_turns(const Model& model, const Vector& positions, Vector& turns);

/// Writes `turns` into the entries of `controls` through which elements see them.
void enter_turns(const Model& model, const Vector& turns, Vector& controls);

/// The followed edge that has turned by more than a quarter turn from its value in `turns`, too far
/// for the shorter way to be certain; -1 if none has.
Index edge_turned_too_far(const Model& model, const Vector& positions, const Vector& turns);

}  // namespace der
