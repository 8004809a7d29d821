#include "der/supports/clamp.hpp"

#include <cmath>

#include "der/kinematics/planar_edge.hpp"

namespace der {
namespace {

Vec2 edge_vector(const RodLayout& rod, Index edge, const Model& model) {
  const auto dofs = rod.edge_dofs(edge, model);
  return Vec2(model.initial_positions[dofs[2]], model.initial_positions[dofs[3]]) -
         Vec2(model.initial_positions[dofs[0]], model.initial_positions[dofs[1]]);
}

double direction(const Vec2& e) { return std::atan2(e.y(), e.x()); }

/// Turning angle at the node nearest to `place` that has two edges, per metre [1/m].
double initial_curvature(const RodLayout& rod, Index place, const Model& model) {
  if (rod.num_edges() < 2) return 0.0;
  const Index inner = std::min(std::max<Index>(place, 1), rod.num_edges() - 1);
  return angle_between(edge_vector(rod, inner - 1, model), edge_vector(rod, inner, model)) /
         rod.voronoi_length(inner);
}

struct HalfCell {
  Index edge;
  double side;
};

}  // namespace

double initial_tangent_angle(const RodLayout& rod, Index place, const Model& model) {
  const double curvature = initial_curvature(rod, place, model);
  const bool leaves = place < rod.num_edges();
  const Index edge = leaves ? place : place - 1;
  const double half = 0.5 * rod.edge_length[static_cast<std::size_t>(edge)];
  return direction(edge_vector(rod, edge, model)) + (leaves ? -curvature : curvature) * half;
}

void add_clamp(const scenario::Support& support, const RodLayout& rod, Index place, Model& model) {
  const double tangent = initial_tangent_angle(rod, place, model);
  const Index rotation = support.rotation ? model.controls.add(*support.rotation) : -1;
  const Vec2 t{std::cos(tangent), std::sin(tangent)};
  for (const HalfCell cell : {HalfCell{place - 1, -1.0}, HalfCell{place, 1.0}}) {
    if (cell.edge < 0 || cell.edge >= rod.num_edges()) continue;
    const double half = 0.5 * rod.edge_length[static_cast<std::size_t>(cell.edge)];
    const double drawn = cell.side * angle_between(t, edge_vector(rod, cell.edge, model));
    const double rest_angle = rod.natural_curvature.empty()
                                  ? drawn
                                  : rod.natural_curvature[static_cast<std::size_t>(place)] * half;
    const auto add = [&](auto& list, auto measure) {
      list.add(
          rod.edge_dofs(cell.edge, model),
          {rod.EI / half, decltype(measure)::of(rest_angle).kappa, tangent, cell.side, rotation});
    };
    if (rod.curvature == scenario::CurvatureMeasure::Angle) {
      add(std::get<ElementList<PlanarClamp<AngleCurvature>>>(model.elements), AngleCurvature{});
    } else {
      add(std::get<ElementList<PlanarClamp<TangentCurvature>>>(model.elements), TangentCurvature{});
    }
  }
}

}  // namespace der
