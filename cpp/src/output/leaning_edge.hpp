#pragma once

#include "der/core/index.hpp"
#include "der/model/location.hpp"
#include "der/model/model.hpp"
#include "der/supports/clamp.hpp"

namespace der {

/// How much further from a clamp [m] than its middle lies the place at which the unloaded rod has
/// the direction of the effective edge, where the drawn shape is the natural one: the chord from a
/// pivot on the tangent, at the share p of the edge, has the curve's direction at 1/(2 (1 - p)).
inline double reference_lean(const RodMesh& rod, Index edge) {
  const double pivot = clamp_pivot_share();
  return 0.5 * pivot / (1.0 - pivot) * rod.edge_length[to_size(rod.position(edge))];
}

/// Rest arc length [m] at which a curve has the direction of an edge that has the curve's mean
/// direction along it, or from a clamp's pivot on.
inline double mean_tangent_place(const RodMesh& rod, Index edge) {
  const double lean = reference_lean(rod, edge);
  return rod.edge_middle(edge) + (rod.clamp_at(edge) != nullptr ? lean : 0.0) -
         (rod.clamp_at(edge + 1) != nullptr ? lean : 0.0);
}

/// Rest arc length [m] at which the unloaded rod has the direction of an edge: that of
/// `tangent_place` where the scene gives the natural curvature, since the cells of a clamp then
/// have it.
inline double natural_tangent_place(const RodMesh& rod, Index edge) {
  const bool is_given = !rod.natural_curvatures.empty() || !rod.natural_curvature.empty();
  return is_given ? tangent_place(rod, edge) : mean_tangent_place(rod, edge);
}

}  // namespace der
