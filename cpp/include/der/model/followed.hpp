#pragma once

#include "der/core/types.hpp"
#include "der/model/edge.hpp"

namespace der {

struct Model;
struct State;

// The coordinates at a time do not tell everything; the state follows the rest from step to step
// (`State::followed`): whole turns of edges of a planar rod, frames of edges in space
// (model/frames.hpp). Elements see it, as it was at the start of a step, through the controls.
// All vectors `followed` have the rotations of the followed edges first, then the blocks of the
// frames.

/// An edge of a planar rod whose whole turns count, because a spring winds up on it, or a clamp
/// turns it. Positions determine the direction of an edge, but not its number of whole turns.
struct FollowedEdge {
  Edge edge;
  double direction = 0.0;  ///< initial one [rad]
  Index turn = -1;  ///< entry of the controls through which elements see what it has turned by
};

/// Number of followed edges.
Index num_turns(const Model& model);
/// Number of numbers about rotations that are saved of each state: one for each followed edge or
/// joint in a plane, a block for each joint in space. A model has one kind or the other.
Index num_saved_turns(const Model& model);
/// These of a state.
Eigen::Ref<const Vector> saved_turns(const Model& model, const State& state);
/// Gives them back to a state whose frames have followed its shape.
void restore_turns(const Model& model, const Eigen::Ref<const Vector>& turns, State& state);
/// Where `followed` has the blocks of the edges' frames.
Eigen::Ref<const Vector> edge_frames(const Model& model, const Vector& followed);
Eigen::Ref<Vector> edge_frames(const Model& model, Vector& followed);
/// Number of entries of a vector `followed` of the model.
Index num_followed(const Model& model);
/// That of the initial shape as it is drawn.
Vector unwrapped_of_reference(const Model& model);

/// Moves `followed` to the shape at `coordinates`, by the shorter way from its present value. The
/// rotations [rad] of edges count from the initial directions. `controls` turn the clamps.
void follow(const Model& model, const Vector& coordinates, const Vector& controls,
            Vector& followed);

/// Writes `followed` into the entries of `controls` through which elements see it.
void enter_followed(const Model& model, const Vector& followed, Vector& controls);

/// First degree of freedom of the end of an edge that has turned by more than a quarter turn from
/// its value in `followed`, too far for the shorter way to be certain; -1 if none has.
Index turned_too_far(const Model& model, const Vector& coordinates, const Vector& controls,
                     const Vector& followed);

}  // namespace der
