#include "der/supports/written_turns.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/kinematics/section_frame.hpp"
#include "der/model/followed.hpp"
#include "der/model/frames.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/section_chain.hpp"

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

/// Moves the rotations of joints to a written shape, to within the bending of one edge. Whole turns
/// count along rods, from rod to rod, from rotations that are held; where none is, from one that
/// stays within half a turn of where it was.
void count_rotations(const Model& model, const Vector& controls, Vector& positions) {
  struct End {
    Index rotation;  // degree of freedom
    double turned;   // its edge against the first of its rod, less what drives it [rad]
  };
  struct RodEnds {
    double turned;  // the first edge since the rod was drawn, to within whole turns [rad]
    std::vector<End> ends;
  };
  std::vector<RodEnds> left;  // rods that are to be counted
  std::vector<bool> known(to_size(model.num_dofs()), false);
  for (const RodMesh& rod : model.rods) {
    const Vector turned = turned_along(rod, model, positions);
    std::vector<End> ends;
    const auto add = [&](const LegEnd& end, Index edge) {
      if (end.rotation < 0) return;
      const Index rotation = model.dofs.rotation(end.rotation);
      const double driven = end.driven < 0 ? 0.0 : controls[end.driven];
      ends.push_back({rotation, turned[edge] - driven});
      known[to_size(rotation)] = !model.dofs.is_free(rotation);
    };
    for (const Leg& leg : rod.legs) {
      add(leg.start, leg.first);
      add(leg.end, leg.last - 1);
    }
    if (ends.empty()) continue;
    const Edge first = rod.edge(0, model);
    left.push_back(
        {angle_between(along_edge(first, model.initial_positions), along_edge(first, positions)),
         std::move(ends)});
  }
  const auto count = [&](const RodEnds& rod, const End& from) {
    const double turned = nearest_turn(rod.turned, positions[from.rotation] - from.turned);
    for (const End& end : rod.ends) {
      if (!known[to_size(end.rotation)]) positions[end.rotation] = turned + end.turned;
      known[to_size(end.rotation)] = true;
    }
  };
  while (!left.empty()) {
    const auto count_if_known = [&](const RodEnds& rod) {
      const auto from = std::find_if(rod.ends.begin(), rod.ends.end(),
                                     [&](const End& end) { return known[to_size(end.rotation)]; });
      if (from == rod.ends.end()) return false;
      count(rod, *from);
      return true;
    };
    const auto rest = std::remove_if(left.begin(), left.end(), count_if_known);
    if (rest == left.end()) count(left.front(), left.front().ends.front());
    left.erase(rest, left.end());
  }
}

/// Whether a program has turned clamps at rest, so far that frames do not tell the way.
bool has_turned_clamps_at_once(const Model& model, const State& state) {
  if (state.last_step > 0.0) return false;
  bool any = false;
  for_each_turning_control(model, [&](Index control) {
    const Ramp* ramp = find_ramp(state, control);
    any = any || (ramp != nullptr && std::abs(ramp->at(state.time) - ramp->from) > 0.5 * kPi);
  });
  return any;
}

auto frames_in(const Model& model, Vector& followed) {
  return followed.tail(model.initial_frames.size());
}

/// The angle [rad] of an edge's section; of none, as beside a clamp, 0.
double angle_of(Index edge, const Model& model, const State& state) {
  return edge < 0 ? 0.0 : state.positions[model.framed_edges[to_size(edge)].theta];
}

}  // namespace

void follow_written(const Model& model, State& state) {
  Vector controls;
  evaluate_controls(model, state, state.time, controls);
  if (model.has_rotations() && model.dimension == 2) {
    count_rotations(model, controls, state.positions);
  }
  if (state.followed.size() == 0) return;
  if (state.followed == unwrapped_of_reference(model)) {
    state.followed = followed_with_clamps(model, controls);
  }
  follow(model, state.positions, controls, state.followed);
  if (model.dimension != 2) return;
  for (const RodMesh& rod : model.rods) count_along(rod, model, state);
}

bool lost_angles(const Model& model, const State& state) {
  Vector controls;
  evaluate_controls(model, state, state.time, controls);
  const bool never_moved = state.followed == unwrapped_of_reference(model);
  return (never_moved && largest_turn_of_clamps(model, controls) > 0.0) ||
         has_turned_clamps_at_once(model, state) ||
         turned_too_far(model, state.positions, controls, state.followed) >= 0;
}

void follow_written_angles(const Model& model, State& state) {
  const Configuration here = configuration_of(model, state);
  const bool in_motion = state.last_step > 0.0;
  if (in_motion && turned_too_far(model, state.positions, here.controls, state.followed) < 0) {
    return follow(model, state);
  }
  const std::vector<SectionChain> chains = section_chains(model);
  state.followed = unwrapped_of_reference(model);
  auto frames = frames_in(model, state.followed);
  lay_frames(model, chains, here, frames);
  const auto strain_without_reference = [&](const SectionChain::Link& link) {
    return link.offset(here.controls) + angle_of(link.after, model, state) -
           angle_of(link.before, model, state);
  };
  for (const SectionChain& chain : chains) {
    if (!chain.has_end()) continue;
    const SectionChain::Link& end = chain.links.back();
    double strain = end.vertex->rest.twist;
    if (chain.links.size() > 1) {
      const SectionChain::Link& last = chain.links[chain.links.size() - 2];
      strain += (strain_without_reference(last) + frames[last.twist] - last.vertex->rest.twist) *
                end.vertex->twist_length / last.vertex->twist_length;
    }
    frames[end.twist] = strain - strain_without_reference(end);
  }
  follow(model, state);
}

void count_angles_from_shape(const Model& model, State& state) {
  if (model.framed_edges.empty()) return;
  follow(model, state);
  const Vector old = frames_in(model, state.followed);
  auto frames = frames_in(model, state.followed);
  const std::vector<SectionChain> chains = section_chains(model);
  lay_frames(model, chains, configuration_of(model, state), frames);
  Vector turned = Vector::Zero(static_cast<Index>(model.framed_edges.size()));
  const auto turned_at = [&](Index edge) { return edge < 0 ? 0.0 : turned[edge]; };
  for (const SectionChain& chain : chains) {
    if (!chain.links.front().leaves_clamp()) {
      const Index edge = chain.first_edge();
      turned[edge] = twist_between(reference_frame(edge, frames), reference_frame(edge, old));
    }
    for (const SectionChain::Link& link : chain.links) {
      if (&link == &chain.links.back() && chain.has_end()) break;
      turned[link.after] = turned_at(link.before) + old[link.twist] - frames[link.twist];
    }
  }
  for (const FramedVertex& vertex : model.framed_vertices) {
    const Index twist = vertex.twist();
    frames[twist] = old[twist] + turned_at(vertex.before) - turned_at(vertex.after);
  }
  state.positions.segment(model.dofs.angle(0), turned.size()) += turned;
  follow(model, state);
}

}  // namespace der
