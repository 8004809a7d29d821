#include "der/loads/circulatory.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/core/nearest_node.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/frames.hpp"
#include "der/model/location.hpp"
#include "der/model/section_place.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/section_spring.hpp"
#include "der/supports/spring.hpp"
#include "model/actuated_turn.hpp"
#include "model/corner.hpp"
#include "model/curvature_jump.hpp"

namespace der {
namespace {

void set_amount(const scenario::VectorSeries& amount, CirculatoryLoad& load, Model& model) {
  for (std::size_t c = 0; c < to_size(model.dimension); ++c) {
    load.amount.components[c] = model.tables.add(component_of(amount, c));
  }
}

/// The point at arc length `s` [m] as a local coordinate.
void add_point(double s, const RodMesh& rod, const Model& model, CirculatoryLoad& load) {
  for (int c = 0; c < model.dimension; ++c) {
    auto& component = load.coordinates.emplace_back();
    for (const auto& [place, weight] : node_weights(rod, s, model)) {
      component.push_back({model.dof(rod.node(place), c), weight});
    }
  }
}

/// The vector of an edge as a local coordinate, from the first degrees of freedom of its nodes.
void add_vector(Index start, Index end, const Model& model, CirculatoryLoad& load) {
  for (int c = 0; c < model.dimension; ++c) {
    load.coordinates.push_back({{end + c, 1.0}, {start + c, -1.0}});
  }
}

FramedEdge framed_edge(Index number, const Model& model) {
  return {model.framed_edges[to_size(number)], FrameBlock::of(number),
          initial_frame(model, number)};
}

/// Angle [rad] by which an edge at a free end leans further than a chord of the drawn curve, if it
/// had that curve without stress: edges of a rod with a natural curvature do (supports/spring.hpp).
double reference_lean(Index edge, const RodMesh& rod, const Model& model) {
  if (rod.closed || rod.natural_curvature.empty()) return 0.0;
  const auto node = [&](Index place) -> Vec2 {
    return model.reference_positions.segment<2>(model.dof(rod.node(place), 0));
  };
  const auto at_end = [&](Index end, Index inner) {
    const bool bends = rod.is_inner(inner) && rod.clamp_at(inner) == nullptr;
    if (!bends || rod.clamp_at(end) != nullptr || is_corner(rod, inner, model)) return 0.0;
    const double turn =
        angle_between(Vec2(node(inner) - node(inner - 1)), Vec2(node(inner + 1) - node(inner)));
    return rod.edge_length[to_size(edge)] / 12.0 * turn / rod.voronoi_length(inner);
  };
  double lean = 0.0;
  if (edge == 0) lean -= at_end(0, 1);
  if (edge == rod.num_edges() - 1) lean += at_end(edge + 1, edge);
  return lean;
}

/// By how much the tangent at arc length `s` [m] turns further than the edges on its two sides,
/// from the drawn shape to a natural one [rad]; of one edge, not at all.
Vec3 natural_turn(double s, const SectionPlace& place, const RodMesh& rod) {
  if (place.direction.size() != 2) return Vec3::Zero();
  return natural_turn_from_line(s, place.first_edge, rod);
}

/// Weights of the directions of edges that a load follows. A planar rod turns by less than its
/// outermost edge against the next one at a free end, on either side of that edge's middle.
std::array<double, 2> in_bending(const SectionPlace& place, const RodMesh& rod,
                                 const Model& model) {
  const std::vector<double>& given = place.direction;
  if (given.size() == 1) return weights_in_bending({given[0], 0.0});
  std::array<double, 2> weights{given[0], given[1]};
  if (model.dimension == 2 && !rod.closed) {
    const bool at_start = place.first_edge == 0 && rod.clamp_at(0) == nullptr;
    const bool at_end =
        place.first_edge + 2 == rod.num_edges() && rod.clamp_at(rod.num_edges()) == nullptr;
    if (at_start) return turn_of_outermost_edge(weights, 0);
    if (at_end) return turn_of_outermost_edge(weights, 1);
  }
  return weights_in_bending(weights);
}

PlanarFollowerForce planar_follower(double s, const SectionPlace& place, const RodMesh& rod,
                                    const Model& model, CirculatoryLoad& load) {
  PlanarFollowerForce follower;
  const double kink = natural_turn(s, place, rod).z();
  const std::array<double, 2> weights = in_bending(place, rod, model);
  for (std::size_t i = 0; i < place.direction.size(); ++i) {
    const Index number = rod.position(place.first_edge + static_cast<Index>(i));
    const EffectiveEdge edge = effective_edge(rod, number, model);
    const Vec2 chord = edge.drawn(model.reference_positions).normalized();
    const Vec2 drawn = Eigen::Rotation2Dd(reference_lean(number, rod, model) - kink) * chord;
    follower.edges.push_back({edge, weights[i], drawn});
    add_vector(edge.dofs[0], edge.dofs[2], model, load);
  }
  if (const auto beside = place_beside_clamp(rod, s)) {
    follower.share = beside->share();
    follower.clamp_turn = rod.clamps[to_size(beside->clamp)].rotation;
  }
  return follower;
}

/// The edges of a place in space, each with what `make` makes of it and of its number among them.
template <class Kind, class Make>
Kind with_edges(const SectionPlace& place, const RodMesh& rod, const Model& model,
                CirculatoryLoad& load, const Make& make) {
  Kind kind;
  for (std::size_t i = 0; i < place.direction.size(); ++i) {
    const Index edge = rod.position(place.first_edge + static_cast<Index>(i));
    const FramedEdge framed = framed_edge(rod.first_edge + edge, model);
    kind.edges.push_back(make(framed, i));
    add_vector(framed.edge.start, framed.edge.end, model, load);
    load.coordinates.push_back({{framed.edge.theta, 1.0}});
  }
  return kind;
}

/// How far the section at a place turns further than its edges under a moment [rad/(N m)], in the
/// axes of the drawn section.
Mat3 compliance_of(const SectionPlace& place, const SpatialMoment& moment, const RodMesh& rod) {
  const auto along = [](const Vec3& axis, double cell, double stiffness) -> Mat3 {
    if (stiffness == 0.0) return Mat3::Zero();
    return cell / stiffness * axis * axis.transpose();
  };
  const SectionFrame& drawn = moment.edges.front().drawn;
  return along(drawn.first, place.bend_cell, rod.EI_2) +
         along(drawn.second, place.bend_cell, rod.EI_1) +
         along(drawn.tangent, place.twist_cell, rod.GJ);
}

/// The actuated section for loads that follow the section at arc length `s` [m].
ActuatedSection actuated_section(double s, const SectionPlace& place, const RodMesh& rod,
                                 const Model& model) {
  const std::array<double, 2> weights = in_bending(place, rod, model);
  ActuatedSection section{actuated_turn_of_follower(s, place, weights, rod), Mat3::Zero()};
  if (model.dimension == 2) {
    section.axes.col(0) = Vec3::UnitZ();
    if (place_beside_clamp(rod, s)) section.turn = actuated_turn(s, rod);
  } else {
    const Index nearer = weights[1] > weights[0] ? 1 : 0;
    const Index edge = rod.position(place.first_edge + nearer);
    section.axes = turning_axes(initial_frame(model, rod.first_edge + edge));
  }
  return section;
}

/// A moment that acts on the edges.
SpatialMoment moment_on_edges(bool follower, double s, const SectionPlace& place,
                              const RodMesh& rod, const Model& model, CirculatoryLoad& load) {
  auto moment = with_edges<SpatialMoment>(
      place, rod, model, load, [&](const FramedEdge& framed, std::size_t i) {
        return SpatialMoment::TurnedEdge{framed, place.direction[i], place.across[i],
                                         place.along[i]};
      });
  moment.follower = follower;
  moment.compliance = compliance_of(place, moment, rod);
  moment.turns_further = !place_beside_clamp(rod, s) && beyond_outer_middle(rod, s) == 0.0;
  return moment;
}

/// The moments and the following forces of a rod at one place, by their numbers in
/// ElementLists::circulatory.
struct SectionLoads {
  double arc_length = 0.0;  // [m]
  std::vector<Index> moments;
  std::vector<Index> forces;
};

SectionLoads& loads_at(double s, const RodMesh& rod, std::vector<SectionLoads>& places) {
  for (SectionLoads& place : places) {
    if (std::abs(place.arc_length - s) <= rod.same_place()) return place;
  }
  return places.emplace_back(SectionLoads{s, {}, {}});
}

std::vector<SectionLoads> section_loads(const RodMesh& rod) {
  std::vector<SectionLoads> places;
  for (const SpatialMomentPlace& moment : rod.spatial_moments) {
    loads_at(moment.arc_length, rod, places).moments.push_back(moment.load);
  }
  for (const ForcePlace& force : rod.force_places) {
    if (force.follower < 0) continue;
    loads_at(force.arc_length, rod, places).forces.push_back(force.follower);
  }
  return places;
}

bool follows(const CirculatoryLoad& moment) {
  return std::get<SpatialMoment>(moment.kind).follower;
}

/// Whether a place is known by an edge at a free end that leans against the natural curve, while
/// the drawn edge is a chord of the drawn one (supports/spring.hpp).
bool beside_leaning_end(double s, const RodMesh& rod) {
  if (rod.closed || rod.natural_curvatures.empty()) return false;
  const SectionPlace place = section_place(s, rod);
  const Index last = place.first_edge + static_cast<Index>(place.direction.size());
  return (place.first_edge == 0 && rod.clamp_at(0) == nullptr) ||
         (last == rod.num_edges() && rod.clamp_at(rod.num_edges()) == nullptr);
}

/// Whether a clamp that holds its section is beside the place.
bool beside_held_section(double s, const RodMesh& rod) {
  const auto beside = place_beside_clamp(rod, s);
  return beside && rod.clamps[to_size(beside->clamp)].holds_section;
}

/// Whether a clamp that lets the section spin is beside the place, or there: it takes up a part of
/// a moment, and passes on what this has about the tangent at the place.
bool beside_held_tangent(double s, const RodMesh& rod) {
  const auto beside = place_beside_clamp(rod, s);
  return beside && !rod.clamps[to_size(beside->clamp)].holds_section;
}

/// Whether the place is beyond the middle of an outermost edge and not at its free end. There a
/// moment bends the rod up to the place, which the edges do not tell of one that follows.
bool is_before_free_end(double s, const RodMesh& rod) {
  const double from_end = std::min(s, rod.rest_length() - s);
  return beyond_outer_middle(rod, s) > 0.0 && from_end > rod.same_place();
}

/// Whether the edges tell less than the loads at a place need. Moments of a fixed direction act on
/// the edges alike, one or many, but what they store is not the sum of what each of them would.
bool need_section(const SectionLoads& place, const RodMesh& rod, const Model& model) {
  const double s = place.arc_length;
  if (is_held_or_at_corner(s, rod, model)) return true;
  if (rod.EI_1 <= 0.0 || rod.EI_2 <= 0.0 || rod.GJ <= 0.0) return false;
  if (!place.moments.empty() && place.moments.size() + place.forces.size() > 1) return true;
  if (!place.moments.empty() && beside_held_tangent(s, rod)) return true;
  const auto& loads = circulatory_loads(*model.elements);
  const bool moment_follows =
      std::any_of(place.moments.begin(), place.moments.end(),
                  [&](Index moment) { return follows(loads[to_size(moment)]); });
  if (moment_follows && is_before_free_end(s, rod)) return true;
  const bool any_follows = moment_follows || !place.forces.empty();
  return any_follows && (beside_held_section(s, rod) || beside_leaning_end(s, rod) ||
                         !natural_turn(s, section_place(s, rod), rod).isZero(0.0));
}

/// `actuated`: the turn of the section beyond the edges that moments turn.
template <int Edges>
void act_on_section(const typename SectionSpring<Edges>::Constants& section,
                    const ActuatedTurn& actuated, const SectionLoads& place,
                    std::vector<CirculatoryLoad>& loads) {
  LoadedSection<Edges> loaded;
  loaded.section = section;
  const Mat3 axes = turning_axes(section.spring.drawn);
  for (const Index number : place.moments) {
    CirculatoryLoad& load = loads[to_size(number)];
    const auto& on_edges = std::get<SpatialMoment>(load.kind);
    const bool follower = on_edges.follower;
    loaded.edges.assign(on_edges.edges.begin(), on_edges.edges.end());
    if (follower) load.amount.actuated = {actuated, axes};
    load.kind = HeldMoment<Edges>{loaded, follower};
    loaded.moments.push_back({load.amount, follower});
  }
  for (const Index number : place.forces) {
    CirculatoryLoad& load = loads[to_size(number)];
    const auto& on_edges = std::get<FollowerForce>(load.kind);
    loaded.edges.assign(on_edges.edges.begin(), on_edges.edges.end());
    load.amount.actuated = {actuated, axes};
    load.kind = HeldForce<Edges>{loaded};
  }
}

/// Beyond an outermost middle a moment at the place bends the rod up to it, so that edges tell its
/// tangent with the weights by which the moment turns them.
void follow_as_moments(const MomentPlace& place, const RodMesh& rod, const Model& model,
                       PlanarFollowerForce& follower) {
  const Eigen::Rotation2Dd to_natural(natural_turn_of_edges(rod, place, model));
  for (std::size_t i = 0; i < place.weights.size(); ++i) {
    PlanarFollowerForce::FollowedEdge& followed = follower.edges[i];
    const Vec2 chord = followed.edge.drawn(model.reference_positions).normalized();
    followed.weight = place.weights[i];
    followed.drawn = to_natural * chord;
  }
}

Index add(CirculatoryLoad&& load, Model& model) {
  auto& loads = circulatory_loads(*model.elements);
  loads.push_back(std::move(load));
  return static_cast<Index>(loads.size()) - 1;
}

}  // namespace

Index add_follower_force(const scenario::VectorSeries& force, double s, const RodMesh& rod,
                         Model& model) {
  CirculatoryLoad load;
  set_amount(force, load, model);
  add_point(s, rod, model, load);
  if (!rod.legs.empty()) {
    const Index number = rod.rotation_at(nearest_node(rod.arc_length, s));
    if (number < 0)
      throw Error("model_error", "rod '" + rod.name + "' turns no force: its EI is 0");
    const Index rotation = model.dofs.rotation(number);
    for (Index c = 0; c < (model.dimension == 3 ? 3 : 1); ++c) {
      load.coordinates.push_back({{rotation + c, 1.0}});
    }
    if (model.dimension == 3) {
      load.kind = SpatialJointFollowerForce{rotation, joint_block(model, number)};
    } else {
      load.kind = JointFollowerForce{rotation};
    }
    return add(std::move(load), model);
  }
  const SectionPlace place = section_place(s, rod);
  load.amount.actuated = actuated_section(s, place, rod, model);
  if (model.dimension == 2) {
    load.kind = planar_follower(s, place, rod, model, load);
  } else {
    load.kind = with_edges<FollowerForce>(
        place, rod, model, load, [&](const FramedEdge& framed, std::size_t i) {
          return FollowerForce::FollowedEdge{framed, place.direction[i]};
        });
  }
  return add(std::move(load), model);
}

void add_spatial_moment(const scenario::VectorSeries& moment, bool follower, double s, RodMesh& rod,
                        Model& model) {
  CirculatoryLoad load;
  set_amount(moment, load, model);
  if (!rod.legs.empty()) {
    const Index number = rod.rotation_at(nearest_node(rod.arc_length, s));
    const Index rotation = model.dofs.rotation(number);
    for (Index c = 0; c < 3; ++c) load.coordinates.push_back({{rotation + c, 1.0}});
    load.kind = JointMoment{rotation, joint_block(model, number), follower};
    add(std::move(load), model);
    return;
  }
  const SectionPlace place = section_place(s, rod);
  if (follower) load.amount.actuated = actuated_section(s, place, rod, model);
  load.kind = moment_on_edges(follower, s, place, rod, model, load);
  rod.spatial_moments.push_back({s, add(std::move(load), model), {}});
}

void act_on_loaded_sections(const RodMesh& rod, Model& model) {
  auto& loads = circulatory_loads(*model.elements);
  for (const SectionLoads& place : section_loads(rod)) {
    if (!need_section(place, rod, model)) continue;
    const double s = place.arc_length;
    // Springs have it in the section that they hold.
    const bool on_springs = rod.section_spring_at(s) != nullptr;
    const ActuatedTurn actuated = on_springs ? ActuatedTurn() : actuated_turn_at(s, rod, model);
    const HeldSectionAt section = held_section_at(s, rod, model);
    if (const auto* on_one = std::get_if<SectionSpring<1>::Constants>(&section)) {
      act_on_section<1>(*on_one, actuated, place, loads);
    } else {
      act_on_section<2>(std::get<SectionSpring<2>::Constants>(section), actuated, place, loads);
    }
  }
}

void turn_followers_under_moments(const RodMesh& rod, Model& model) {
  for (const ForcePlace& force : rod.force_places) {
    if (force.follower < 0 || rod.EI == 0.0) continue;
    const double s = force.arc_length;
    const MomentPlace* place = rod.moment_place_at(s);
    if (place == nullptr) continue;
    CirculatoryLoad& load = circulatory_loads(*model.elements)[to_size(force.follower)];
    auto& follower = std::get<PlanarFollowerForce>(load.kind);
    if (beyond_outer_middle(rod, s) > 0.0) {
      follow_as_moments(*place, rod, model, follower);
      load.amount.actuated.turn = actuated_turn(s, rod);
    }
    const double share = place->series_share(rod.EI);
    // The spring takes as much of the clamp's part of the turn.
    const double by_clamp = share * (1.0 - follower.share);
    follower.share *= share;
    if (follower.share != 1.0) follower.held_share = by_clamp / (1.0 - follower.share);
    auto& turned = load.amount.actuated.turn.terms;
    for (ActuatedTurn::Term& term : turned) term.weight *= share;
    for (const Index moment : place->moments) {
      turned.push_back({0, moment, share * place->cell_length / rod.EI});
    }
  }
}

}  // namespace der
