#include "model/actuated_turn.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/model/location.hpp"

namespace der {
namespace {

/// Arc length [m] of the clamp beside a place.
double clamp_beside(double s, const PlaceBesideClamp& beside, const RodMesh& rod) {
  const bool is_before = rod.clamps[to_size(beside.clamp)].place == beside.edge;
  return is_before ? s - beside.distance : s + beside.distance;
}

}  // namespace

scenario::EdgeTurns edge_turns(const ActuatedStretch& stretch, const RodMesh& rod, Index edge) {
  return scenario::edge_turns({stretch.profile, stretch.from, stretch.to}, rod.arc_length_at(edge),
                              rod.arc_length_at(edge + 1), rod.clamp_at(edge) != nullptr,
                              rod.clamp_at(edge + 1) != nullptr);
}

void ActuatedTurnTo::from_edge(Index edge, double bend, double twist) {
  from(rod_.arc_length_at(edge), bend, 0.0);
  from(rod_.edge_middle(edge), 0.0, twist);
  for (const ActuatedStretch& stretch : rod_.actuated_stretches) {
    if (stretch.what != scenario::Actuated::Curvature) continue;
    add(stretch, -bend * edge_turns(stretch, rod_, rod_.position(edge)).at_start);
  }
}

void ActuatedTurnTo::from(double place, double bend, double twist) {
  for (const ActuatedStretch& stretch : rod_.actuated_stretches) {
    if (!stretch.strains()) continue;
    const double weight = stretch.what == scenario::Actuated::Twist ? twist : bend;
    add(stretch, weight * integral(stretch, place, s_));
  }
}

void ActuatedTurnTo::add(const ActuatedStretch& stretch, double weight) {
  if (weight == 0.0) return;
  const Index first = stretch.what == scenario::Actuated::Twist ? 2 : 0;
  for (Index i = 0; i < 2; ++i) {
    const Index control = stretch.controls[to_size(i)];
    if (control < 0) continue;
    const auto known = std::find_if(turn_.terms.begin(), turn_.terms.end(),
                                    [&](const auto& term) { return term.control == control; });
    if (known != turn_.terms.end()) {
      known->weight += weight;
    } else {
      turn_.terms.push_back({first + i, control, weight});
    }
  }
}

/// Integral of the profile [m]; a ring goes on beyond its ends.
double ActuatedTurnTo::integral(const ActuatedStretch& stretch, double a, double b) const {
  const Index most = rod_.closed ? 1 : 0;
  double sum = 0.0;
  for (Index turns = -most; turns <= most; ++turns) {
    const double ahead = turns * rod_.rest_length();
    sum += stretch.integral(a + ahead, b + ahead);
  }
  return sum;
}

ActuatedTurn actuated_turn(double s, const RodMesh& rod) {
  ActuatedTurnTo turn(s, rod);
  for (const auto& [edge, weight] : edge_weights(rod, s)) turn.from_edge(edge, weight, 0.0);
  if (const auto beside = place_beside_clamp(rod, s)) {
    turn.from(clamp_beside(s, *beside, rod), 1.0 - beside->share(), 0.0);
  }
  return turn.turn();
}

ActuatedTurn actuated_turn(double s, const SectionPlace& place, const RodMesh& rod) {
  ActuatedTurnTo turn(s, rod);
  for (std::size_t i = 0; i < place.across.size(); ++i) {
    turn.from_edge(place.first_edge + static_cast<Index>(i), place.across[i], place.along[i]);
  }
  if (const auto beside = place_beside_clamp(rod, s)) {
    turn.from(clamp_beside(s, *beside, rod), 1.0 - place.across[0], 1.0 - place.along[0]);
  }
  return turn.turn();
}

ActuatedTurn actuated_turn_of_follower(double s, const SectionPlace& place,
                                       const std::array<double, 2>& in_bending,
                                       const RodMesh& rod) {
  ActuatedTurnTo turn(s, rod);
  for (std::size_t i = 0; i < place.direction.size(); ++i) {
    turn.from_edge(place.first_edge + static_cast<Index>(i), in_bending[i], place.direction[i]);
  }
  return turn.turn();
}

Vec3 value_of(const ActuatedTurn& turn, const Model& model, const State& state) {
  return turn.value([&](Index control) { return control_value(model, state, control); });
}

ActuatedTurn actuated_turn_from_edge(Index edge, double s, const RodMesh& rod) {
  ActuatedTurnTo turn(s, rod);
  turn.from_edge(edge, 1.0, 1.0);
  return turn.turn();
}

ActuatedTurn actuated_turn_from(const RodVertex& vertex, double s, const RodMesh& rod) {
  ActuatedTurnTo turn(s, rod);
  const Index place = vertex.place();
  const auto add_side = [&](Index own, Index edge) {
    if (own < 0) {
      turn.from(rod.arc_length_at(place), 0.5, 0.5);  // of the clamp
    } else {
      turn.from_edge(edge, 0.5, 0.5);
    }
  };
  add_side(vertex.before, place - 1);
  add_side(vertex.after, place);
  return turn.turn();
}

}  // namespace der
