#include "statics/continuation/plane_watch.hpp"

#include <algorithm>
#include <utility>

namespace der::statics {
namespace {

/// Places are located to this fraction of the step in which they lie.
constexpr double kPlace = 1e-11;

}  // namespace

void PlaneMonitor::look(PathNode& node) {
  if (test_ == nullptr) return;
  const Configuration& here = equations_.configuration_at(node);
  if (!by_pivots_) by_pivots_ = test_->is_clear(here);
  node.out_of_plane = *by_pivots_ ? test_->stability_by_pivots(here) : test_->stability(here);
}

void PlaneMonitor::locate(const PathNode& start, double reached, const PathNode& end,
                          std::vector<LocatedEvent>& events) {
  const auto unstable = [](const PathNode& node) { return node.out_of_plane.unstable_directions; };
  PathNode before = start;
  double low = 0.0;
  // Directions may change at several places, the first of which bisection finds each time.
  while (unstable(before) != unstable(end)) {
    PathNode after = end;
    double high = reached;
    while (high - low > kPlace * reached) {
      const double middle = 0.5 * (low + high);
      int iterations = 0;
      auto found = equations_.next(start, middle, iterations);
      if (!found) break;
      look(*found);
      if (unstable(*found) == unstable(before)) {
        low = middle;
        before = std::move(*found);
      } else {
        high = middle;
        after = std::move(*found);
      }
    }
    LocatedEvent& event = events.emplace_back();
    event.step = high;
    event.lost_directions = unstable(after) - unstable(before);
    event.out_of_plane = true;
    Index& unknown = after.out_of_plane.unknown_directions;
    unknown = std::max(unknown, before.out_of_plane.unknown_directions);
    before = after;
    low = high;
    event.node = std::move(after);
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const auto& a, const auto& b) { return a.step < b.step; });
}

}  // namespace der::statics
