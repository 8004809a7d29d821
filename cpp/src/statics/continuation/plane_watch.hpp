#pragma once

#include <vector>

#include "der/statics/out_of_plane.hpp"
#include "statics/continuation/path_equations.hpp"
#include "statics/continuation/path_events.hpp"

namespace der::statics {

/// Watches whether the equilibria of a planar path are stable against motion out of their plane.
class PlaneWatch {
 public:
  /// `test` is null where nothing is tested.
  PlaneWatch(PathEquations& equations, OutOfPlaneTest* test) : equations_(equations), test_(test) {}

  /// Counts the unstable directions of a node.
  void look(PathNode& node);

  /// Adds the places between two neighbours, `reached` apart, at which the number of unstable
  /// directions changes, to the events there, in their order. Both have been looked at.
  void locate(const PathNode& start, double reached, const PathNode& end,
              std::vector<LocatedEvent>& events);

 private:
  PathEquations& equations_;
  OutOfPlaneTest* test_;
};

}  // namespace der::statics
