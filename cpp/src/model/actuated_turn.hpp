#pragma once

#include <array>

#include "der/kinematics/actuated_turn.hpp"
#include "der/model/model.hpp"
#include "der/model/section_place.hpp"
#include "der/model/state.hpp"
#include "der/scenario/stretch_profile.hpp"

namespace der {

// An edge has the mean of the directions that actuations give the rod along it (docs/actuation.md),
// and its section is that in its middle. At a place, the rod is turned on from there by the
// integral of the actuated curvatures and twist, which no line between edges follows.

/// The turn of an edge for a unit of an actuated curvature [m].
scenario::EdgeTurns edge_turns(const ActuatedStretch& stretch, const RodMesh& rod, Index edge);

/// The actuated turn to a place, from where the parts of a weighted sum are.
class ActuatedTurnTo {
 public:
  /// `s`: rest arc length [m].
  ActuatedTurnTo(double s, const RodMesh& rod) : s_(s), rod_(rod) {}

  /// From an edge, those of a ring counted on, with these weights of its direction and its twist.
  void from_edge(Index edge, double bend, double twist);
  /// From another place [m].
  void from(double place, double bend, double twist);
  [[nodiscard]] ActuatedTurn turn() const { return turn_; }

 private:
  void add(const ActuatedStretch& stretch, double weight);
  [[nodiscard]] double integral(const ActuatedStretch& stretch, double a, double b) const;

  double s_;
  const RodMesh& rod_;
  ActuatedTurn turn_;
};

/// From the edges that moments at arc length `s` [m] turn, and the clamp beside them; in a plane.
ActuatedTurn actuated_turn(double s, const RodMesh& rod);
/// The same in space.
ActuatedTurn actuated_turn(double s, const SectionPlace& place, const RodMesh& rod);
/// From the edges that a load at arc length `s` [m] follows, with these weights of their
/// directions.
ActuatedTurn actuated_turn_of_follower(double s, const SectionPlace& place,
                                       const std::array<double, 2>& in_bending, const RodMesh& rod);

/// The turn at a state.
Vec3 value_of(const ActuatedTurn& turn, const Model& model, const State& state);

/// To arc length `s` [m] from an edge, whose direction is the mean along it.
ActuatedTurn actuated_turn_from_edge(Index edge, double s, const RodMesh& rod);
/// The same from the mean of the directions and sections on the two sides of a vertex.
ActuatedTurn actuated_turn_from(const RodVertex& vertex, double s, const RodMesh& rod);

}  // namespace der
