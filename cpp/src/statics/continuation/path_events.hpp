#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/statics/continuation.hpp"
#include "statics/continuation/path_equations.hpp"

namespace der::statics {

/// A place at which the factor turns, or directions gain or lose their stability.
struct LocatedEvent {
  double step = 0.0;  ///< arc length from the node before
  PathNode node;
  bool factor_turns = false;
  Index lost_directions = 0;
  double reach = 0.0;         ///< to either side, within which the place is uncertain
  bool out_of_plane = false;  ///< whether it is one of directions out of the plane

  /// At a limit point the factor turns and a direction loses its stability. Where only one of the
  /// two happens another path crosses: on a branch that passes through a symmetric bifurcation
  /// again the factor turns, but both of its sides are alike.
  [[nodiscard]] PathEvent event() const {
    if (out_of_plane) return PathEvent::OutOfPlane;
    return factor_turns && lost_directions != 0 ? PathEvent::Fold : PathEvent::Bifurcation;
  }
};

/// Finds the events between two neighbouring nodes.
class EventLocator {
 public:
  EventLocator(PathEquations& equations, double largest_step)
      : equations_(equations), largest_step_(largest_step) {}

  /// Finds the events from `start` to `end`, which lies `reached` ahead, in their order. Returns
  /// false if the two lie on different paths.
  bool locate(const PathNode& start, double reached, const PathNode& end,
              std::vector<LocatedEvent>& events);

  /// Makes one of events at one place. All are on the way from `start`.
  void merge(std::vector<LocatedEvent>& events, const PathNode& start);

 private:
  /// The part of the way from `start` that is searched: arc lengths, and the nodes there.
  struct Interval {
    double low;
    PathNode before;
    double high;
    PathNode after;
  };
  bool bisect(const PathNode& start, double whole, Interval interval,
              std::vector<LocatedEvent>& events);
  double reach_of(const LocatedEvent& event, const PathNode& start);

  PathEquations& equations_;
  double largest_step_;
};

}  // namespace der::statics
