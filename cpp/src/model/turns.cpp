#include "der/model/turns.hpp"

#include <cmath>

#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/model.hpp"

namespace der {
namespace {

Vec2 vector_of(const FollowedEdge& edge, const Vector& positions) {
  const auto& [x0, y0, x1, y1] = edge.dofs;
  return {positions[x1] - positions[x0], positions[y1] - positions[y0]};
}

Vec2 turned_by(const FollowedEdge& edge, double turn) {
  return {std::cos(edge.direction + turn), std::sin(edge.direction + turn)};
}

}  // namespace

void follow_turns(const Model& model, const Vector& positions, Vector& turns) {
  for (Index i = 0; i < turns.size(); ++i) {
    const FollowedEdge& edge = model.followed_edges[at(i)];
    turns[i] += angle_between(turned_by(edge, turns[i]), vector_of(edge, positions));
  }
}

void enter_turns(const Model& model, const Vector& turns, Vector& controls) {
  for (Index i = 0; i < turns.size(); ++i) {
    controls[model.followed_edges[at(i)].turn] = turns[i];
  }
}

Index edge_turned_too_far(const Model& model, const Vector& positions, const Vector& turns) {
  for (Index i = 0; i < turns.size(); ++i) {
    const FollowedEdge& edge = model.followed_edges[at(i)];
    if (turned_by(edge, turns[i]).dot(vector_of(edge, positions)) < 0.0) return i;
  }
  return -1;
}

}  // namespace der
