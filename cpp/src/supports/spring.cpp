#include "der/supports/spring.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "der/core/index.hpp"
#include "der/core/nearest_node.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/joint_spring.hpp"
#include "der/energies/point_spring.hpp"
#include "der/energies/rotational_spring.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/dimension.hpp"
#include "der/model/frames.hpp"
#include "der/model/location.hpp"
#include "der/model/moment_place.hpp"
#include "der/scenario/support.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/section_spring.hpp"
#include "energies/add_element.hpp"
#include "model/curvature_jump.hpp"

namespace der {
namespace {

template <int Dim, int Nodes>
void add_point_spring(const scenario::Spring& spring, RodMesh& rod, double s,
                      const std::vector<Weighted>& weights, Model& model) {
  using Kernel = PointSpring<Dim, Nodes>;
  using Point = typename Kernel::Point;
  std::array<Index, Kernel::kDofs> dofs{};
  typename Kernel::Constants constants;
  constants.stiffness = Eigen::Map<const Point>(spring.stiffness.data());
  for (int i = 0; i < Nodes; ++i) {
    const auto& [place, weight] = weights[to_size(i)];
    const Index first = model.dof(rod.node(place), 0);
    for (int c = 0; c < Dim; ++c) dofs[to_size(Dim * i + c)] = first + c;
    constants.weights[i] = weight;
    constants.anchor += weight * model.initial_positions.segment<Dim>(first);
  }
  if (!spring.anchor.empty()) constants.anchor = Eigen::Map<const Point>(spring.anchor.data());
  elements_of<Kernel>(*model.elements).add(dofs, constants);
  ForcePlace place;
  place.arc_length = s;
  place.stiffness.head<Dim>() = constants.stiffness;
  place.anchor.head<Dim>() = constants.anchor;
  rod.force_places.push_back(place);
}

/// Each number of nodes has a kind of element of its own.
template <int Dim, int Nodes = 1>
void add_point_spring_at(const scenario::Spring& spring, RodMesh& rod, double s,
                         const std::vector<Weighted>& weights, Model& model) {
  if constexpr (Nodes < kMostPointNodes) {
    if (to_size(Nodes) < weights.size()) {
      return add_point_spring_at<Dim, Nodes + 1>(spring, rod, s, weights, model);
    }
  }
  add_point_spring<Dim, Nodes>(spring, rod, s, weights, model);
}

/// Turn [rad] that is drawn between the two edges of a place; 0 of one edge.
double reference_bend(const RodMesh& rod, const MomentPlace& place, const Model& model) {
  if (place.weights.size() == 1) return 0.0;
  const Vector& drawn = model.reference_positions;
  return angle_between(effective_edge(rod, place.first_edge, model).drawn(drawn),
                       effective_edge(rod, place.first_edge + 1, model).drawn(drawn));
}

/// Turn [rad] of the weighted directions, from the initial direction of the first edge, at which
/// the tangent has the direction of the drawn shape and no moment acts.
double rest_turn(const RodMesh& rod, const MomentPlace& place, const Model& model) {
  const bool single = place.weights.size() == 1;
  const double drawn = single ? 0.0 : place.weights[1] * reference_bend(rod, place, model);
  return drawn + natural_turn_of_edges(rod, place, model);
}

/// Returns the number of the element in its list.
template <int Edges>
Index add_element_of(const RodMesh& rod, MomentPlace& place, Model& model) {
  using Kernel = RotationalSpring<Edges>;
  std::array<Index, Kernel::kDofs> dofs{};
  for (Index i = 0; i <= Edges; ++i) {
    for (int c = 0; c < 2; ++c) {
      dofs[to_size(2 * i + c)] = model.dof(rod.node(place.first_edge + i), c);
    }
  }
  const EffectiveEdge first = effective_edge(rod, place.first_edge, model);
  const EffectiveEdge last = effective_edge(rod, place.first_edge + Edges - 1, model);
  const Vec2 along = first.drawn(model.reference_positions);
  typename Kernel::Constants constants;
  constants.stiffness = place.stiffness * place.series_share(rod.EI);
  place.followed = follow_edge(rod, place.first_edge, model);
  constants.direction = std::atan2(along.y(), along.x());
  constants.turn = model.followed_edges[to_size(place.followed)].turn;
  constants.rest = rest_turn(rod, place, model);
  std::copy(place.weights.begin(), place.weights.end(), constants.weights.begin());
  constants.total = std::accumulate(place.weights.begin(), place.weights.end(), 0.0);
  constants.actuated = place.spring_shift;
  if (const auto beside = place_beside_clamp(rod, place.arc_length)) {
    constants.clamp_share = 1.0 - beside->share();
    constants.clamp_turn = rod.clamps[to_size(beside->clamp)].rotation;
  }
  return add_element<Kernel>(dofs, constants, first.first, last.last, *model.elements);
}

}  // namespace

std::array<double, 2> natural_turn_lengths(const RodMesh& rod, double s, Index first_edge,
                                           const std::vector<double>& weights) {
  std::array<double, 2> lengths{};
  if (rod.closed || place_beside_clamp(rod, s)) return lengths;
  const Index last_edge = rod.num_edges() - 1;
  const bool single = weights.size() == 1;
  if (const double beyond = beyond_outer_middle(rod, s); beyond > 0.0) {
    const double inward = single
                              ? 0.0
                              : -std::min(weights[0], weights[1]) *
                                    (rod.edge_middle(first_edge + 1) - rod.edge_middle(first_edge));
    const bool start = s < rod.edge_middle(0);
    lengths[start ? 0 : 1] = (start ? 1.0 : -1.0) * (beyond - inward);
  }
  if (single) return lengths;
  const auto turn = [&](Index edge) {
    return weights[to_size(edge - first_edge)] * rod.edge_length[to_size(edge)] / 12.0;
  };
  if (first_edge == 0 && rod.clamp_at(0) == nullptr) lengths[0] -= turn(0);
  if (first_edge + 1 == last_edge && rod.clamp_at(rod.num_edges()) == nullptr) {
    lengths[1] += turn(last_edge);
  }
  return lengths;
}

double natural_turn_of_edges(const RodMesh& rod, const MomentPlace& place, const Model& model) {
  if (rod.natural_curvature.empty()) return 0.0;
  const double s = place.arc_length;
  const auto [at_start, at_end] = natural_turn_lengths(rod, s, place.first_edge, place.weights);
  double turn = at_start * rod.natural_curvature.front() + at_end * rod.natural_curvature.back();
  if (place.weights.size() == 1) return turn;
  const double first_middle = rod.edge_middle(place.first_edge);
  const double spacing = rod.edge_middle(place.first_edge + 1) - first_middle;
  const double share = (s - first_middle) / spacing;
  turn += (share - place.weights[1]) * reference_bend(rod, place, model);
  return turn - natural_turn_from_line(s, place.first_edge, rod).z();
}

SpatialJointSpring::Constants joint_spring(const scenario::Spring& spring, double s,
                                           const RodMesh& rod, const Model& model) {
  const Index place = nearest_node(rod.arc_length, s);
  SpatialJointSpring::Constants c;
  c.stiffness = Eigen::Map<const Vec3>(spring.rotational_stiffness.data());
  for (const Leg& leg : rod.legs) {
    for (const auto& [at, end] : {std::pair(leg.last, &leg.end), {leg.first, &leg.start}}) {
      if (at != place || end->rotation < 0) continue;
      c.section = {end->section, joint_block(model, end->rotation)};
    }
  }
  return c;
}

void add_spring(const scenario::Support& support, Model& model) {
  const scenario::Spring& spring = *support.spring;
  RodMesh& rod = model.rod(support.rod);
  const double s = arc_length_of(support.at, rod);
  if (!spring.stiffness.empty()) {
    const std::vector<Weighted> weights = node_weights(rod, s, model);
    with_dimension(model,
                   [&](auto dim) { add_point_spring_at<dim>(spring, rod, s, weights, model); });
  }
  if (spring.rotational_stiffness.empty()) return;
  if (const Index rotation = rod.legs.empty() ? -1 : rod.rotation_at(node_at(support.at, rod));
      rotation >= 0) {
    const Index first = model.dofs.rotation(rotation);
    if (model.dimension == 3) {
      elements_of<SpatialJointSpring>(*model.elements)
          .add({first, first + 1, first + 2}, joint_spring(spring, s, rod, model));
    } else {
      elements_of<JointSpring<1>>(*model.elements).add({first}, {spring.rotational_stiffness[0]});
    }
  } else if (model.dimension == 2) {
    place_of_moments(s, rod).stiffness += spring.rotational_stiffness[0];
  } else {
    add_to_section_spring(s, Eigen::Map<const Vec3>(spring.rotational_stiffness.data()), rod);
  }
}

void add_rotational_springs(RodMesh& rod, Model& model) {
  Index number = 0;
  for (MomentPlace& place : rod.moment_places) {
    // Clamps may have come since.
    const double stiffness = place.stiffness;
    place = moment_place(place.arc_length, rod);
    place.stiffness = stiffness;
    place.spring_shift = rod.natural_strain_entries.spring(number++);
    place.spring = place.weights.size() == 1 ? add_element_of<1>(rod, place, model)
                                             : add_element_of<2>(rod, place, model);
  }
}

}  // namespace der
