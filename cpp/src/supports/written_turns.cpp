#include "der/supports/written_turns.hpp"

#include <vector>

#include "der/kinematics/planar_edge.hpp"
#include "der/kinematics/section_frame.hpp"
#include "der/model/followed.hpp"
#include "der/supports/clamp.hpp"

namespace der {
namespace {

/// `State::followed` of the shape as it is drawn, with each clamp turned already.
Vector followed_with_clamps(const Model& model, const Vector& controls) {
  Vector followed = unwrapped_of_reference(model);
  for (const RodMesh& rod : model.rods) {
    for (const Clamp& clamp : rod.clamps) {
      if (clamp.followed >= 0) followed[clamp.followed] = controls[clamp.rotation];
    }
  }
  return followed;
}

/// The angles [rad] by which the edges of a planar rod have turned against its first one since they
/// were drawn.
Vector turned_along(const RodMesh& rod, const Model& model, const Vector& positions) {
  const auto angle_after = [&](Index edge, const Vector& shape) {
    return angle_between(along_edge(rod.edge(edge, model), shape),
                         along_edge(rod.edge(edge + 1, model), shape));
  };
  Vector turned = Vector::Zero(rod.num_edges());
  for (Index edge = 0; edge + 1 < rod.num_edges(); ++edge) {
    turned[edge + 1] =
        turned[edge] + angle_after(edge, positions) - angle_after(edge, model.initial_positions);
  }
  return turned;
}

void count_along(const RodMesh& rod, const Model& model, State& state) {
  struct Place {
    Index edge;
    Index followed;
  };
  std::vector<Place> places;  // the first is what the others count from
  for (const MomentPlace& spring : rod.moment_places) {
    if (spring.followed >= 0) places.push_back({spring.first_edge, spring.followed});
  }
  const Clamp* fixed = nullptr;
  for (const Clamp& clamp : rod.clamps) {
    if (clamp.followed >= 0) {
      places.push_back({edge_beside(rod, clamp.place), clamp.followed});
    } else {
      fixed = &clamp;
    }
  }
  if (places.empty() || (places.size() == 1 && fixed == nullptr)) return;
  const Vector turned = turned_along(rod, model, state.positions);
  double first = state.followed[places.front().followed] - turned[places.front().edge];
  if (fixed != nullptr) {
    const Index beside = edge_beside(rod, fixed->place);
    const Edge edge = rod.edge(beside, model);
    first = angle_between(along_edge(edge, model.initial_positions),
                          along_edge(edge, state.positions)) -
            turned[beside];
  }
  for (const Place& place : places) {
    double& turn = state.followed[place.followed];
    turn = nearest_turn(turn, first + turned[place.edge]);
  }
}

}  // namespace

void follow_written(const Model& model, State& state) {
  if (state.followed.size() == 0) return;
  Vector controls;
  evaluate_controls(model, state, state.time, controls);
  if (state.followed == unwrapped_of_reference(model)) {
    state.followed = followed_with_clamps(model, controls);
  }
  follow(model, state.positions, controls, state.followed);
  if (model.dimension != 2) return;
  for (const RodMesh& rod : model.rods) count_along(rod, model, state);
}

}  // namespace der
