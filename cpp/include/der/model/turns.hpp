#pragma once

#include "der/core/types.hpp"
#include "der/model/edge.hpp"

namespace der {

struct Model;

/// An edge whose turning counts in whole turns too: a spring winds up on it, or a clamp turns it. A
/// shape says the direction of an edge, but not how often it has gone round, so the state follows
/// it from step to step (`State::turns`).
struct FollowedEdge {
  Edge edge;
  double direction = 0.0;  ///< as drawn [rad]
  Index turn = -1;  ///< entry of the controls through which elements see what it has turned by
};

/// Sets `turns` [rad], one for each followed edge of the model, to those at `positions`: counted
/// from the drawn directions, and the shorter way from what `turns` says.
void follow_turns(const Model& model, const Vector& positions, Vector& turns);

/// Writes `turns` into the entries of `controls` through which elements see them.
void enter_turns(const Model& model, const Vector& turns, Vector& controls);

/// The followed edge that lies more than a quarter of a turn from what `turns` says, too far for
/// the shorter way to be known; -1 if none does.
Index edge_turned_too_far(const Model& model, const Vector& positions, const Vector& turns);

}  // namespace der
