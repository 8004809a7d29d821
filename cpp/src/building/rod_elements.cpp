#include "der/building/rod_elements.hpp"

#include "der/core/index.hpp"
#include "der/core/reserve_more.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/stretch.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/spring.hpp"
#include "energies/add_element.hpp"

namespace der {
namespace {

template <class Kernel>
void make_room_for_elements(Index count, Model& model) {
  ElementList<Kernel>& list = elements_of<Kernel>(*model.elements);
  reserve_more(list.dofs, to_size(count));
  reserve_more(list.constants, to_size(count));
}

/// One for each edge of the rod.
std::vector<EffectiveEdge> effective_edges(const RodMesh& rod, const Model& model) {
  std::vector<EffectiveEdge> edges;
  edges.reserve(to_size(rod.num_edges()));
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    edges.push_back(effective_edge(rod, edge, model));
  }
  return edges;
}

/// An effective edge from a pivot is shorter than its edge and stretches for all of it.
void add_stretch(const RodMesh& rod, const std::vector<EffectiveEdge>& edges, Model& model) {
  make_room_for_elements<Stretch<2>>(rod.num_edges(), model);
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    const EffectiveEdge& effective = edges[to_size(edge)];
    const double length = effective.has_pivot() ? effective.drawn(model.reference_positions).norm()
                                                : rod.edge_length[to_size(edge)];
    const double EA = rod.EA * (length / rod.edge_length[to_size(edge)]);
    add_element<Stretch<2>>(effective.dofs, {EA, length, rod.natural_strain_entries.edge(edge)},
                            effective.first, effective.last, *model.elements);
  }
}

double rest_angle_between(const RodMesh& rod, Index place, const EffectiveEdge& before,
                          const EffectiveEdge& after, const Model& model) {
  if (rod.natural_curvature.empty()) {
    return angle_between(before.drawn(model.reference_positions),
                         after.drawn(model.reference_positions));
  }
  double angle = rod.natural_curvature[to_size(rod.position(place))] * bend_length(rod, place);
  if (rod.closed) return angle;
  // A free end lies on the curve, the nodes next to it l^2 kappa/12 beside it (supports/clamp.hpp).
  const auto end = [&](Index end_place, Index edge) {
    if (rod.clamp_at(end_place) != nullptr) return;
    angle += rod.natural_curvature[to_size(end_place)] * rod.edge_length[to_size(edge)] / 12.0;
  };
  if (place == 1) end(0, 0);
  if (place == rod.num_edges() - 1) end(rod.num_edges(), rod.num_edges() - 1);
  return angle;
}

template <class Curvature>
void add_bend(RodMesh& rod, const std::vector<EffectiveEdge>& edges, Model& model) {
  make_room_for_elements<PlanarBend<Curvature>>(rod.num_edges(), model);
  // That between the last edge of a ring and its first one stands last.
  for (Index i = 1; i <= rod.num_edges(); ++i) {
    if (!rod.is_inner(i) || rod.clamp_at(i) != nullptr) continue;
    const EffectiveEdge& before = edges[to_size(i - 1)];
    const EffectiveEdge& after = edges[to_size(rod.edge_after(i))];
    const double rest = rest_angle_between(rod, i, before, after, model);
    rod.rest_turning_angle[to_size(rod.position(i))] = rest;
    add_element<PlanarBend<Curvature>>({before.dofs[0], before.dofs[1], after.dofs[0],
                                        after.dofs[1], after.dofs[2], after.dofs[3]},
                                       {rod.EI / bend_length(rod, i), Curvature::of(rest).kappa,
                                        rod.natural_strain_entries.cell(rod.position(i), false)},
                                       before.first, after.last, *model.elements);
  }
}

}  // namespace

void add_rod_elements(RodMesh& rod, Model& model) {
  rod.rest_turning_angle.assign(rod.nodes.size(), 0.0);
  const std::vector<EffectiveEdge> edges = effective_edges(rod, model);
  add_stretch(rod, edges, model);
  if (rod.EI == 0.0) return;
  if (rod.curvature == scenario::CurvatureMeasure::Angle) {
    add_bend<AngleCurvature>(rod, edges, model);
  } else {
    add_bend<TangentCurvature>(rod, edges, model);
  }
  for (const Clamp& clamp : rod.clamps) add_clamp_cells(clamp, rod, model);
  add_rotational_springs(rod, model);
}

}  // namespace der
