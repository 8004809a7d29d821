#include "der/supports/clamp.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/index.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/planar_clamp.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/clamp_cell.hpp"
#include "der/model/location.hpp"
#include "der/scenario/support.hpp"
#include "model/corner.hpp"
#include "model/corner_twist.hpp"
#include "model/curvature_jump.hpp"
#include "model/pivot_offset.hpp"
#include "model/reference_edge.hpp"
#include "supports/leg_clamp.hpp"

namespace der {
namespace {

double direction(const Vec2& e) { return std::atan2(e.y(), e.x()); }

/// Turning angle at the node nearest to `place` that has two edges, per metre [1/m]; none between
/// `place` and a corner. Where the curvature jumps, that of the edge after `place`.
double initial_curvature(const RodMesh& rod, Index place, const Model& model) {
  if (rod.num_edges() < 2) return 0.0;
  const Index inner = inner_place_near(rod, place);
  if (inner != place && is_corner(rod, inner, model)) return 0.0;
  const double mean =
      angle_between(reference_edge(rod, inner - 1, model), reference_edge(rod, inner, model)) /
      rod.voronoi_length(inner);
  if (inner != place) return mean;
  return mean + curvature_beyond_mean(rod, place, true, rod.reference_jumps).z();
}

/// +1 if the edge leaves the clamp, -1 if it arrives there.
double side_of(const Clamp& clamp, Index edge) { return edge == clamp.place ? 1.0 : -1.0; }

/// A clamp as an edge beside it sees it.
Clamp clamp_of(const Clamp& clamp, Index edge, const RodMesh& rod, const Model& model) {
  return clamp_of_leg(clamp, side_of(clamp, edge) < 0.0, rod, model);
}

Pivot pivot_at(const RodMesh& rod, Index place, Index edge, const Model& model) {
  const Clamp* clamp = rod.clamp_at(place);
  if (clamp == nullptr) return {};
  return {side_of(*clamp, edge) * kPivotShare * rod.edge_length[to_size(edge)],
          clamp_of(*clamp, edge, rod, model).direction, clamp->rotation};
}

}  // namespace

Index edge_beside(const RodMesh& rod, Index place) {
  return rod.edge_after(place) >= 0 ? place : place - 1;
}

Index inner_place_near(const RodMesh& rod, Index place) {
  if (rod.is_inner(place)) return place;
  return std::clamp<Index>(place, 1, rod.num_edges() - 1);
}

double initial_tangent_angle(const RodMesh& rod, Index place, const Model& model) {
  if (is_corner(rod, place, model))
    return direction(leg_tangent(rod, place, false, model).head<2>());
  const double curvature = initial_curvature(rod, place, model);
  const bool leaves = rod.edge_after(place) >= 0;
  const Index edge = leaves ? place : place - 1;
  const double half = 0.5 * rod.edge_length[to_size(edge)];
  return direction(reference_edge(rod, edge, model)) + (leaves ? -curvature : curvature) * half;
}

double tangent_angle(const Clamp& clamp, const Model& model, const State& state) {
  if (clamp.rotation < 0) return clamp.direction;
  return clamp.direction + control_value(model, state, clamp.rotation);
}

double largest_turn_of_clamps(const Model& model, const Vector& controls) {
  double largest = 0.0;
  for_each_turning_control(
      model, [&](Index control) { largest = std::max(largest, std::abs(controls[control])); });
  return largest;
}

void hold_tangent(const scenario::Support& support, Index place, RodMesh& rod, Model& model) {
  if (rod.EI == 0.0 || rod.clamp_at(place) != nullptr) return;
  const Index rotation = support.rotation ? model.tables.add(*support.rotation) : -1;
  const Index beside = edge_beside(rod, place);
  const Index followed = support.rotation ? follow_edge(rod, beside, model) : -1;
  rod.clamps.push_back(
      {place, initial_tangent_angle(rod, place, model), rotation, followed, {}, true});
}

EffectiveEdge effective_edge(const RodMesh& rod, Index edge, const Model& model) {
  const Index own = rod.position(edge);  // behind the last edge of a ring its first one follows
  return {rod.edge_dofs(own, model), pivot_at(rod, own, own, model),
          pivot_at(rod, own + 1, own, model)};
}

Vec2 effective_end(const EffectiveEdge& effective, bool last, const Model& model,
                   const State& state) {
  const std::size_t x = last ? 2 : 0;
  return Vec2(state.positions[effective.dofs[x]], state.positions[effective.dofs[x + 1]]) +
         offset_of(last ? effective.last : effective.first, model, state);
}

Vec2 effective_vector(const EffectiveEdge& effective, const Model& model, const State& state) {
  return effective_end(effective, true, model, state) -
         effective_end(effective, false, model, state);
}

double bend_length(const RodMesh& rod, Index place) {
  double length = rod.voronoi_length(place);
  if (rod.clamp_at(place - 1) != nullptr)
    length -= kFirstVertexCorrection * rod.edge_length[to_size(rod.edge_before(place))];
  if (rod.clamp_at(place + 1) != nullptr)
    length -= kFirstVertexCorrection * rod.edge_length[to_size(rod.edge_after(place))];
  return length;
}

double clamp_cell_length(const RodMesh& rod, Index edge) {
  return kCellShare * rod.edge_length[to_size(edge)];
}

double clamp_rest_angle(const RodMesh& rod, const Clamp& clamp, Index edge, const Model& model) {
  const double side = side_of(clamp, edge);
  if (rod.natural_curvature.empty()) {
    const double held = clamp_of(clamp, edge, rod, model).direction;
    const Vec2 tangent{std::cos(held), std::sin(held)};
    const Vec2 effective = effective_edge(rod, edge, model).drawn(model.reference_positions);
    return side * angle_between(tangent, effective);
  }
  const bool leaves = side > 0.0;
  const Index next = clamp.place + (leaves ? 1 : -1);
  const double at_pivot = (1.0 - kPivotShare) * planar_curvature_beside(rod, clamp.place, leaves) +
                          kPivotShare * planar_curvature_beside(rod, next, !leaves);
  return at_pivot * clamp_cell_length(rod, edge);
}

double clamp_pivot_share() { return kPivotShare; }

void add_clamp_cells(const Clamp& clamp, RodMesh& rod, Model& model) {
  const double corner = clamp.direction - clamp_of_leg(clamp, true, rod, model).direction;
  rod.rest_turning_angle[to_size(clamp.place)] += corner;
  for (const Index edge : {rod.edge_before(clamp.place), rod.edge_after(clamp.place)}) {
    if (edge < 0) continue;
    const EffectiveEdge effective = effective_edge(rod, edge, model);
    const double rest = clamp_rest_angle(rod, clamp, edge, model);
    rod.rest_turning_angle[to_size(clamp.place)] += rest;
    const auto add = [&](auto measure) {
      using Measure = decltype(measure);
      auto& list = elements_of<FromPivot<PlanarClamp<Measure>>>(*model.elements);
      list.add(effective.dofs,
               {{rod.EI / clamp_cell_length(rod, edge), Measure::of(rest).kappa,
                 clamp_of(clamp, edge, rod, model).direction, side_of(clamp, edge), clamp.rotation,
                 rod.natural_strain_entries.cell(clamp.place, side_of(clamp, edge) > 0.0)},
                effective.first,
                effective.last});
    };
    if (rod.curvature == scenario::CurvatureMeasure::Angle) {
      add(AngleCurvature{});
    } else {
      add(TangentCurvature{});
    }
  }
}

}  // namespace der
