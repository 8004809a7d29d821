#include "der/supports/spring.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "der/core/index.hpp"
#include "der/energies/registry.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/location.hpp"

namespace der {
namespace {

Vec2 drawn_node(const RodLayout& rod, Index place, const Model& model) {
  return model.initial_positions.segment<2>(model.dof(rod.nodes[at(place)], 0));
}

Vec2 drawn_edge(const RodLayout& rod, Index edge, const Model& model) {
  return drawn_node(rod, edge + 1, model) - drawn_node(rod, edge, model);
}

double middle(const RodLayout& rod, Index edge) {
  return 0.5 * (rod.arc_length[at(edge)] + rod.arc_length[at(edge + 1)]);
}

template <int Nodes>
void add_point_spring(const scenario::Spring& spring, const RodLayout& rod,
                      const std::vector<Weighted>& weights, Model& model) {
  using Kernel = PointSpring<Nodes>;
  std::array<Index, Kernel::kDofs> dofs{};
  typename Kernel::Constants constants;
  constants.stiffness = Eigen::Map<const Vec2>(spring.stiffness.data());
  for (int i = 0; i < Nodes; ++i) {
    const auto& [place, weight] = weights[at(i)];
    for (int c = 0; c < 2; ++c) dofs[at(2 * i + c)] = model.dof(rod.nodes[at(place)], c);
    constants.weights[i] = weight;
    constants.anchor += weight * drawn_node(rod, place, model);
  }
  if (!spring.anchor.empty()) constants.anchor = Eigen::Map<const Vec2>(spring.anchor.data());
  std::get<ElementList<Kernel>>(model.elements).add(dofs, constants);
}

/// The one or two edges that a spring against turning acts on, in the order of the arc length.
struct Stencil {
  Index first = 0;
  std::vector<double> weights;
};

Stencil stencil_at(const RodLayout& rod, double s) {
  const std::vector<Weighted> edges = edge_weights(rod, s);
  if (edges.size() == 1) return {edges.front().place, {edges.front().weight}};
  const bool ascending = edges[0].place < edges[1].place;
  const Weighted& a = edges[ascending ? 0 : 1];
  const Weighted& b = edges[ascending ? 1 : 0];
  return {a.place, {a.weight, b.weight}};
}

/// Distance [m] from the middle of the outermost edge to a place beyond it; 0 for places inside.
double beyond_middle(const RodLayout& rod, double s) {
  return std::max({0.0, middle(rod, 0) - s, s - middle(rod, rod.num_edges() - 1)});
}

/// c: by how much the weighted directions turn against the tangent under a unit moment over EI [m].
double cell_length(const RodLayout& rod, double s, const Stencil& stencil) {
  const double beyond = beyond_middle(rod, s);
  if (stencil.weights.size() == 1) return 2.0 / 3.0 * beyond;
  const double spacing = middle(rod, stencil.first + 1) - middle(rod, stencil.first);
  if (beyond == 0.0) return stencil.weights[0] * stencil.weights[1] * spacing;
  const double share = -std::min(stencil.weights[0], stencil.weights[1]);
  return beyond - share * (2.0 + share) * spacing;
}

/// Turn [rad] of the weighted directions, from the first edge as drawn, at which the tangent has
/// the direction of the drawn shape and no moment acts.
double rest_turn(const RodLayout& rod, double s, const Stencil& stencil, const Model& model) {
  const bool single = stencil.weights.size() == 1;
  const double bend = single ? 0.0
                             : angle_between(drawn_edge(rod, stencil.first, model),
                                             drawn_edge(rod, stencil.first + 1, model));
  if (rod.natural_curvature.empty()) return single ? 0.0 : stencil.weights[1] * bend;

  // The drawn tangent, and what the natural curvature makes of the cell. The nodes lie on the drawn
  // curve, but beside the free one, but for the end (supports/clamp.hpp).
  const double spacing = single ? 1.0 : middle(rod, stencil.first + 1) - middle(rod, stencil.first);
  const double tangent = (s - middle(rod, stencil.first)) / spacing * bend;
  const double beyond = beyond_middle(rod, s);
  if (beyond == 0.0) return tangent;
  const bool start = s < middle(rod, 0);
  const Index end = start ? 0 : rod.num_edges();
  const double outer = rod.edge_length[at(start ? 0 : rod.num_edges() - 1)];
  const double share = single ? 0.0 : -std::min(stencil.weights[0], stencil.weights[1]);
  const double cell = single ? beyond : beyond - share * spacing - (1.0 + share) * outer / 12.0;
  return tangent + (start ? cell : -cell) * rod.natural_curvature[at(end)];
}

/// 1 / (1 + k c / EI): the stiffness of spring and cell in series, against the spring's.
double series_share(const RodLayout& rod, const TangentSpring& spring, const Stencil& stencil) {
  return 1.0 / (1.0 + spring.stiffness * cell_length(rod, spring.arc_length, stencil) / rod.EI);
}

template <int Edges>
void add_element(const RodLayout& rod, const TangentSpring& spring, const Stencil& stencil,
                 Model& model) {
  using Kernel = RotationalSpring<Edges>;
  std::array<Index, Kernel::kDofs> dofs{};
  for (Index i = 0; i <= Edges; ++i) {
    for (int c = 0; c < 2; ++c) {
      dofs[at(2 * i + c)] = model.dof(rod.nodes[at(stencil.first + i)], c);
    }
  }
  typename Kernel::Constants constants;
  constants.stiffness = spring.stiffness * series_share(rod, spring, stencil);
  const FollowedEdge& first = model.followed_edges[at(follow_edge(rod, stencil.first, model))];
  constants.direction = first.direction;
  constants.turn = first.turn;
  constants.rest = rest_turn(rod, spring.arc_length, stencil, model);
  for (std::size_t i = 0; i < Edges; ++i) constants.weights[i] = stencil.weights[i];
  std::get<ElementList<Kernel>>(model.elements).add(dofs, constants);
}

}  // namespace

void add_spring(const scenario::Support& support, Model& model) {
  const scenario::Spring& spring = *support.spring;
  RodLayout& rod = model.rod(support.rod);
  const double s = arc_length_of(support.at, rod);
  if (!spring.stiffness.empty()) {
    const std::vector<Weighted> weights = node_weights(rod, s);
    switch (weights.size()) {
      case 1:
        add_point_spring<1>(spring, rod, weights, model);
        break;
      case 2:
        add_point_spring<2>(spring, rod, weights, model);
        break;
      case 3:
        add_point_spring<3>(spring, rod, weights, model);
        break;
      default:
        add_point_spring<4>(spring, rod, weights, model);
    }
  }
  if (spring.rotational_stiffness == 0.0) return;
  const auto there = std::find_if(
      rod.tangent_springs.begin(), rod.tangent_springs.end(),
      [&](const TangentSpring& t) { return std::abs(t.arc_length - s) <= rod.same_place(); });
  if (there == rod.tangent_springs.end()) {
    rod.tangent_springs.push_back({s, spring.rotational_stiffness});
  } else {
    there->stiffness += spring.rotational_stiffness;
  }
}

void add_rotational_springs(const RodLayout& rod, Model& model) {
  for (const TangentSpring& spring : rod.tangent_springs) {
    const Stencil stencil = stencil_at(rod, spring.arc_length);
    if (stencil.weights.size() == 1) {
      add_element<1>(rod, spring, stencil, model);
    } else {
      add_element<2>(rod, spring, stencil, model);
    }
  }
}

double moment_share(const RodLayout& rod, double s) {
  const TangentSpring* spring = rod.tangent_spring_at(s);
  return spring == nullptr ? 1.0 : series_share(rod, *spring, stencil_at(rod, s));
}

}  // namespace der
