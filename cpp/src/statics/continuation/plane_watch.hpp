#pragma once

#include <optional>
#include <vector>

#include "der/statics/out_of_plane.hpp"
#include "statics/continuation/path_equations.hpp"
#include "statics/continuation/path_events.hpp"

namespace der::statics {

/// Watches whether the equilibria of a planar path are stable against motion out of their plane.
class PlaneMonitor {
 public:
  /// `test` is null where nothing is tested.
  PlaneMonitor(PathEquations& equations, OutOfPlaneTest* test)
      : equations_(equations), test_(test) {}

  /// Judges the stability of a node.
  void look(PathNode& node);

  /// Adds the places between two neighbours, `reached` apart, at which the number of unstable
  /// directions changes, to the events there, in their order. Both have been looked at. Where
  /// rounding hides the stability beside such a place, the place has unknown directions.
  void locate(const PathNode& start, double reached, const PathNode& end,
              std::vector<LocatedEvent>& events);

 private:
  PathEquations& equations_;
  OutOfPlaneTest* test_;
  std::optional<bool> by_pivots_;  // whether these tell the stability; set at the first node
};

}  // namespace der::statics
