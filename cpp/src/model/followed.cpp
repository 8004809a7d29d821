#include "der/model/followed.hpp"

#include <cmath>

#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/frames.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {
namespace {

Vec2 turned_by(const FollowedEdge& edge, double turn) {
  return {std::cos(edge.direction + turn), std::sin(edge.direction + turn)};
}

}  // namespace

Index num_turns(const Model& model) { return static_cast<Index>(model.followed_edges.size()); }

Index num_saved_turns(const Model& model) {
  const Index rotations = model.dofs.num_rotations();
  return model.dimension == 3 ? JointBlock::kSize * (rotations / 3) : num_turns(model) + rotations;
}

Eigen::Ref<const Vector> saved_turns(const Model& model, const State& state) {
  if (model.dimension == 3) return state.followed.tail(num_saved_turns(model));
  if (model.has_rotations()) return state.positions.tail(model.dofs.num_rotations());
  return state.followed.head(num_turns(model));
}

void restore_turns(const Model& model, const Eigen::Ref<const Vector>& turns, State& state) {
  if (model.dimension == 3) {
    state.followed.tail(turns.size()) = turns;
    for (Index rotation = 0; rotation < model.dofs.num_rotations(); rotation += 3) {
      state.positions.segment<3>(model.dofs.rotation(rotation)) =
          turns.segment<3>(JointBlock::kSize * (rotation / 3));
    }
  } else if (model.has_rotations()) {
    state.positions.tail(model.dofs.num_rotations()) = turns;
  } else {
    // Edges that are followed for the slopes alone come last.
    state.followed.head(turns.size()) = turns;
  }
}

Eigen::Ref<const Vector> edge_frames(const Model& model, const Vector& followed) {
  return followed.segment(num_turns(model), FrameBlock::kSize * model.dofs.num_angles());
}

Eigen::Ref<Vector> edge_frames(const Model& model, Vector& followed) {
  return followed.segment(num_turns(model), FrameBlock::kSize * model.dofs.num_angles());
}

Index num_followed(const Model& model) {
  return num_turns(model) + static_cast<Index>(model.initial_frames.size());
}

Vector unwrapped_of_reference(const Model& model) {
  Vector followed = Vector::Zero(num_followed(model));
  followed.tail(model.initial_frames.size()) = model.initial_frames;
  return followed;
}

void follow(const Model& model, const Vector& coordinates, const Vector& controls,
            Vector& followed) {
  for (Index i = 0; i < num_turns(model); ++i) {
    const FollowedEdge& edge = model.followed_edges[to_size(i)];
    followed[i] += angle_between(turned_by(edge, followed[i]), along_edge(edge.edge, coordinates));
  }
  if (model.framed_edges.empty()) return;
  follow_frames(model, coordinates, controls, followed.tail(model.initial_frames.size()));
}

void enter_followed(const Model& model, const Vector& followed, Vector& controls) {
  for (Index i = 0; i < num_turns(model); ++i) {
    controls[model.followed_edges[to_size(i)].turn] = followed[i];
  }
  controls.head(model.initial_frames.size()) = followed.tail(model.initial_frames.size());
}

Index turned_too_far(const Model& model, const Vector& coordinates, const Vector& controls,
                     const Vector& followed) {
  for (Index i = 0; i < num_turns(model); ++i) {
    const FollowedEdge& edge = model.followed_edges[to_size(i)];
    if (turned_by(edge, followed[i]).dot(along_edge(edge.edge, coordinates)) < 0.0) {
      return edge.edge.last;
    }
  }
  if (model.framed_edges.empty()) return -1;
  return frame_turned_too_far(model, coordinates, controls,
                              followed.tail(model.initial_frames.size()));
}

}  // namespace der
