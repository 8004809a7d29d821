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
    double amount = 0.0;              ///< 1 or -1 of a point force; of a load along the rod [m]
    double arc_length = 0.0;          ///< where it is [m]
    std::vector<Weighted> direction;  ///< of the rod there, as that of edges
  };

  double arc_length = 0.0;          ///< [m]
  std::vector<Weighted> edges;      ///< the line through the strains at their middles
  std::vector<Passed> forces;       ///< numbered as in SpreadForces
  std::vector<Passed> distributed;  ///< in RodLayout::distributed_places
  std::vector<Passed> foundations;  ///< in RodLayout::foundation_places
  bool smooth = true;
};

/// The middles of the edges, the ends of the rod, and both sides of every place where the strain
/// may jump or have a kink, in the order of the arc length.
///
/// Two such places bound a part of the rod. The strain in it is a line through the middles of its
/// own edges; through a single one the line has the slope of the loads along the rod. A part
/// without a middle lies within one edge and continues the line of the part beside it, with the
/// loads that act between them.
std::vector<StretchSample> stretch_samples(const RodLayout& rod, const SpreadForces& forces,
                                           const Model& model);

}  // namespace der
