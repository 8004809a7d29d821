#pragma once

#include <vector>

#include "der/model/location.hpp"
#include "der/model/model.hpp"
#include "output/spread_forces.hpp"

namespace der {

/// The strain at a place of a rod, made of the strains at the middles of edges.
struct StretchSample {
  /// A load between the place and these middles that their line does not have.
  struct Passed {
    std::size_t number = 0;
    double amount = 0.0;      ///< 1 or -1 of a point force; of a load along the rod [m]
    double arc_length = 0.0;  ///< where it is [m]
  };
  /// A line through the strains at the middles of edges, continued beyond point forces.
  struct Line {
    std::vector<Weighted> edges;
    std::vector<Passed> forces;  ///< numbered as in SpreadForces
  };
  /// A part of the rod on which the forces across it change the tension as it curves.
  struct Curving {
    double from = 0.0, to = 0.0;  ///< [m]
    double amount = 0.0;          ///< [m], of k . F
    Line line;                    ///< by which it stretches
  };

  double arc_length = 0.0;  ///< [m]
  Line line;
  std::vector<Curving> curving;     ///< what the line does not have of it, or has in excess
  std::vector<Passed> distributed;  ///< in RodMesh::distributed_places
  std::vector<Passed> foundations;  ///< in RodMesh::foundation_places
  bool smooth = true;

  /// A part of `curving` has no other forces than the sample.
  [[nodiscard]] bool passes_loads() const {
    return !line.forces.empty() || !distributed.empty() || !foundations.empty();
  }
};

/// The middles of the edges, the ends of the rod, and both sides of every place where the strain
/// may jump or have a kink, in the order of the arc length.
///
/// Two such places bound a part of the rod. The strain in it is a line through the middles of its
/// own edges. A part without a middle lies within one edge and continues the line of the part
/// beside it, with the loads that act between them. Through a single middle, too, the line has the
/// slope of another part: what differs are the loads along the rod, and the curving under the
/// forces across it; weight and inertia are the same.
std::vector<StretchSample> stretch_samples(const RodMesh& rod, const SpreadForces& forces,
                                           const Model& model);

}  // namespace der
