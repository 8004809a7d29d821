#include "der/model/turns.hpp"

#include <cmath>

#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/model.hpp"

namespace der {
namespace {

Vec2 turned_by(const FollowedEdge& edge, double turn) {
  return {std::cos(edge.direction + turn), std::sin(edge.direction + turn)};
}

}  // namespace

void follow_turns(const Model& model, const Vector& positions, Vector& turns) {
  for (Index i = 0; i < turns.size(); ++i) {
    const FollowedEdge& edge = model.followed_edges[to_size(i)];
    turns[i] += angle_between(turned_by(edge, turns[i]), along_edge(edge.edge, positions));
  }
}

void enter_turns(const Model& model, const Vector& turns, Vector& controls) {
  for (Index i = 0; i < turns.size(); ++i) {
    controls[model.followed_edges[to_size(i)].turn] = turns[i];
  }
}

Index edge_turned_too_far(const Model& model, const Vector& positions, const Vector& turns) {
  for (Index i = 0; i < turns.size(); ++i) {
    const FollowedEdge& edge = model.followed_edges[to_size(i)];
    if (turned_by(edge, turns[i]).dot(along_edge(edge.edge, positions)) < 0.0) return i;
  }
  return -1;
}

}  // namespace der
