#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// How the section of a rod in space at a place is known by those of its edges: weights of one
/// edge, or of two neighbours, which add up to 1 each. Beside a clamp those of moments add up to
/// less, as the clamp takes the rest, and the direction is that of the one edge.
struct SectionPlace {
  Index first_edge = 0;           ///< number in the rod
  std::vector<double> direction;  ///< of the directions, to second order in the edge length
  /// Weights of the rotations on which a moment works by its parts across and along the tangent.
  /// For the part across it they are those of the plane (model/moment_place.hpp). Sections twist at
  /// nodes and lie at the middles of edges without an offset: beyond the outermost middle the
  /// outermost edge has all of the part along the tangent.
  std::vector<double> across;
  std::vector<double> along;
  /// Lengths [m]: the section turns further than the weighted sums, by these over EI and GJ times
  /// the moment that acts there.
  double bend_cell = 0.0;
  double twist_cell = 0.0;
};

/// The section at arc length `s` [m].
SectionPlace section_place(double s, const RodMesh& rod);

}  // namespace der
