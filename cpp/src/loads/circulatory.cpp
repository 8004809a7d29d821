#include "der/loads/circulatory.hpp"

#include <utility>
#include <variant>

#include "der/core/index.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/model/frames.hpp"
#include "der/model/location.hpp"
#include "der/model/section_place.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/section_spring.hpp"
#include "model/actuated_turn.hpp"
#include "model/corner.hpp"

namespace der {
namespace {

void set_amount(const scenario::VectorSeries& amount, CirculatoryLoad& load, Model& model) {
  for (std::size_t c = 0; c < to_size(model.dimension); ++c) {
    load.amount[c] = model.tables.add(component_of(amount, c));
  }
}

/// The point at arc length `s` [m] as a local coordinate.
void add_point(double s, const RodLayout& rod, const Model& model, CirculatoryLoad& load) {
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
  return {model.framed_edges[to_size(number)], FrameBlock::of(number), drawn_frame(model, number)};
}

PlanarFollowerForce planar_follower(const SectionPlace& place, const RodLayout& rod,
                                    const Model& model, CirculatoryLoad& load) {
  PlanarFollowerForce follower;
  for (std::size_t i = 0; i < place.direction.size(); ++i) {
    const EffectiveEdge edge = effective_edge(rod, place.first_edge + static_cast<Index>(i), model);
    const Vec2 drawn = edge.vector(model.initial_positions, 0.0, 0.0).normalized();
    follower.edges.push_back({edge, place.direction[i], drawn});
    add_vector(edge.dofs[0], edge.dofs[2], model, load);
  }
  return follower;
}

/// The edges of a place in space, each with what `make` makes of it and of its number among them.
template <class Kind, class Make>
Kind with_edges(const SectionPlace& place, const RodLayout& rod, const Model& model,
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
Mat3 compliance_of(const SectionPlace& place, const SpatialMoment& moment, const RodLayout& rod) {
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
ActuatedSection actuated_section(double s, const SectionPlace& place, const RodLayout& rod,
                                 const Model& model) {
  const std::vector<double>& weights = place.direction;
  const auto in_bending = weights_in_bending({weights[0], weights.size() > 1 ? weights[1] : 0.0});
  ActuatedSection section{actuated_turn_of_follower(s, place, in_bending, rod), Mat3::Zero()};
  if (model.dimension == 2) {
    section.axes.col(0) = Vec3::UnitZ();
  } else {
    const Index nearer = in_bending[1] > in_bending[0] ? 1 : 0;
    const Index edge = rod.position(place.first_edge + nearer);
    section.axes = turning_axes(drawn_frame(model, rod.first_edge + edge));
  }
  return section;
}

/// A moment that acts on the edges.
SpatialMoment moment_on_edges(bool follower, double s, const SectionPlace& place,
                              const RodLayout& rod, const Model& model, CirculatoryLoad& load) {
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

template <int Edges>
HeldMoment<Edges> held_moment(const typename SectionSpring<Edges>::Constants& section,
                              bool follower, const SectionPlace& place, const RodLayout& rod,
                              const Model& model, CirculatoryLoad& load) {
  auto moment = with_edges<HeldMoment<Edges>>(
      place, rod, model, load, [](const FramedEdge& framed, std::size_t) { return framed; });
  moment.section = section;
  moment.follower = follower;
  return moment;
}

Index add(CirculatoryLoad&& load, Model& model) {
  auto& loads = circulatory_loads(*model.elements);
  loads.push_back(std::move(load));
  return static_cast<Index>(loads.size()) - 1;
}

}  // namespace

Index add_follower_force(const scenario::VectorSeries& force, double s, const RodLayout& rod,
                         Model& model) {
  CirculatoryLoad load;
  set_amount(force, load, model);
  add_point(s, rod, model, load);
  const SectionPlace place = section_place(s, rod);
  load.actuated = actuated_section(s, place, rod, model);
  if (model.dimension == 2) {
    load.kind = planar_follower(place, rod, model, load);
  } else {
    load.kind = with_edges<FollowerForce>(
        place, rod, model, load, [&](const FramedEdge& framed, std::size_t i) {
          return FollowerForce::FollowedEdge{framed, place.direction[i]};
        });
  }
  return add(std::move(load), model);
}

void add_spatial_moment(const scenario::VectorSeries& moment, bool follower, double s,
                        RodLayout& rod, Model& model) {
  CirculatoryLoad load;
  set_amount(moment, load, model);
  const SectionPlace place = section_place(s, rod);
  if (follower) load.actuated = actuated_section(s, place, rod, model);
  const HeldSectionAt held = held_section_at(s, rod, model);
  if (const auto* on_one = std::get_if<SectionSpring<1>::Constants>(&held)) {
    load.kind = held_moment<1>(*on_one, follower, place, rod, model, load);
  } else if (const auto* on_two = std::get_if<SectionSpring<2>::Constants>(&held)) {
    load.kind = held_moment<2>(*on_two, follower, place, rod, model, load);
  } else {
    load.kind = moment_on_edges(follower, s, place, rod, model, load);
  }
  rod.spatial_moments.push_back({s, add(std::move(load), model), {}});
}

}  // namespace der
