#include "der/model/followed.hpp"

#include <cmath>

#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/frames.hpp"
#include "der/model/model.hpp"

namespace der {
namespace {

Vec2 turned_by(const FollowedEdge& edge, double turn) {
  return {std::cos(edge.direction + turn), std::sin(edge.direction + turn)};
}

}  // namespace

Index num_turns(const Model& model) { return static_cast<Index>(model.followed_edges.size()); }

Index num_saved_turns(const Model& model) { return num_turns(model) + model.dofs.num_rotations(); }

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
