#include "statics/continuation/plane_watch.hpp"

#include <algorithm>
#include <utility>

namespace der::statics {
namespace {

/// Places are located to this fraction of the step in which they lie.
constexpr double kPlace = 1e-11;

}  // namespace

void PlaneWatch::look(PathNode& node) {
  if (test_ == nullptr) return;
  node.unstable_out_of_plane = test_->unstable_directions(equations_.configuration_at(node));
}

void PlaneWatch::locate(const PathNode& start, double reached, const PathNode& end,
                        std::vector<LocatedEvent>& events) {
  PathNode before = start;
  double low = 0.0;
  // Directions may change at several places, the first of which bisection finds each time.
  while (before.unstable_out_of_plane != end.unstable_out_of_plane) {
    PathNode after = end;
    double high = reached;
    while (high - low > kPlace * reached) {
      const double middle = 0.5 * (low + high);
      int iterations = 0;
      auto found = equations_.next(start, middle, iterations);
      if (!found) break;
      look(*found);
      if (found->unstable_out_of_plane == before.unstable_out_of_plane) {
        low = middle;
        before = std::move(*found);
      } else {
        high = middle;
        after = std::move(*found);
      }
    }
    LocatedEvent& event = events.emplace_back();
    event.step = high;
    event.lost_directions = after.unstable_out_of_plane - before.unstable_out_of_plane;
    event.out_of_plane = true;
    before = after;
    low = high;
    event.node = std::move(after);
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const auto& a, const auto& b) { return a.step < b.step; });
}

}  // namespace der::statics
