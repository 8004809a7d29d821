#pragma once

#include <vector>

#include "der/model/model.hpp"

namespace der {

/// Curvature [1/m] of a planar rod where no moment acts, at any place of its edges: the values of
/// the scene at the nodes, or those of the initial shape, interpolated and extrapolated linearly
/// within each leg of the rod. The turning angle of two initial edges over their mean length is the
/// curvature a third of their difference beside their node; that of a corner is none.
class NaturalCurvature {
 public:
  NaturalCurvature(const RodMesh& rod, const Model& model);
  /// At arc length `s` [m] of an edge.
  [[nodiscard]] double at(Index edge, double s) const;

 private:
  /// The rod between two corners or ends.
  struct Leg {
    Index end = 0;                   // the edge beyond it
    std::vector<double> arc_length;  // [m]
    std::vector<double> values;      // [1/m]
  };

  void read_given(const std::vector<Index>& bounds, const RodMesh& rod);
  void read_reference(const std::vector<Index>& bounds, const RodMesh& rod, const Model& model);

  std::vector<Leg> legs_;
};

}  // namespace der
