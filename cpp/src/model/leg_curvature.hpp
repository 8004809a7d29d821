#pragma once

#include <algorithm>

#include "der/core/index.hpp"
#include "der/model/leg.hpp"
#include "der/model/model.hpp"
#include "model/curvature_jump.hpp"

namespace der {

/// Natural curvature [1/m] of the scene at a place of a leg, at an end that of the leg's side.
inline double natural_in_leg(const Leg& leg, const RodMesh& rod, Index place) {
  return planar_curvature_beside(rod, place, place == leg.first);
}

/// The turning angle [rad] number `angle` next to an end of a leg that a curvature makes, along the
/// element from that end on. `C`: its compliance (`end_compliance`); `curvature_at(place)` [1/m] is
/// linear between the nodes.
template <class CurvatureAt>
double turn_in_end_cell(const Leg& leg, bool from_start, const Mat3& C, Index angle,
                        const CurvatureAt& curvature_at) {
  const Index joint = from_start ? leg.first : leg.last;
  const Index step = from_start ? 1 : -1;
  double turn = 0.0;
  for (Index k = 0; k <= std::min<Index>(leg.num_cells(), 2); ++k) {
    turn += step * C(angle, k) * curvature_at(joint + step * k);
  }
  return turn;
}

/// The same at an inner node of a leg. A free end is on the curve, the node next to it beside it.
template <class CurvatureAt>
double turn_at_node(const Leg& leg, const RodMesh& rod, Index place,
                    const CurvatureAt& curvature_at) {
  const auto beside_end = [&](Index end, Index edge) {
    return rod.edge_length[to_size(edge)] / 12.0 * curvature_at(end);
  };
  double turn = rod.voronoi_length(place) * curvature_at(place);
  if (place == leg.first + 1) turn += beside_end(leg.first, leg.first);
  if (place == leg.last - 1) turn += beside_end(leg.last, leg.last - 1);
  return turn;
}

}  // namespace der
