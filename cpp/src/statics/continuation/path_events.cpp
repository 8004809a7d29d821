#include "statics/continuation/path_events.hpp"

#include <algorithm>
#include <utility>

namespace der::statics {
namespace {

/// Events are located to this fraction of the step in which they lie.
constexpr double kEventPlace = 1e-11;
/// Events closer than this fraction of that step are treated as one.
constexpr double kSameEvent = 1e-6;
/// Smallest stretch of a path, over the largest step, on which events are treated as one.
constexpr double kOnePlace = 1e-4;
/// Longest stretch, over the largest step, over which a singular stiffness is looked for.
constexpr double kFarthestReach = 0.1;
/// Points to either side of a located event that are farther apart than this, over the largest
/// step, lie on different paths.
constexpr double kJump = 1e-3;

bool same_state(const PathNode& a, const PathNode& b) {
  return a.rising() == b.rising() &&
         a.stability.unstable_directions == b.stability.unstable_directions;
}

}  // namespace

bool EventLocator::locate(const PathNode& start, double reached, const PathNode& end,
                          std::vector<LocatedEvent>& events) {
  return bisect(start, reached, {0.0, start, reached, end}, events);
}

/// Places closer than a fraction of the first interval's length `whole` are treated as one.
bool EventLocator::bisect(const PathNode& start, double whole, Interval interval,
                          std::vector<LocatedEvent>& events) {
  auto& [low, before, high, after] = interval;
  if (same_state(before, after)) return true;
  int iterations = 0;
  while (high - low > kEventPlace * whole) {
    const double middle = 0.5 * (low + high);
    const auto found = equations_.next(start, middle, iterations);
    if (!found) break;
    if (same_state(*found, before)) {
      low = middle;
      before = *found;
    } else if (same_state(*found, after)) {
      high = middle;
      after = *found;
    } else if (high - low > kSameEvent * whole) {
      return bisect(start, whole, {low, before, middle, *found}, events) &&
             bisect(start, whole, {middle, *found, high, after}, events);
    } else {
      break;  // the factor turns where the stiffness loses its rank: one event, to rounding
    }
  }
  if (equations_.metric().distance(after.at, before.at) > kJump * largest_step_) return false;
  const Index lost = after.stability.unstable_directions - before.stability.unstable_directions;
  events.push_back({high, after, before.rising() != after.rising(), lost, 0.0});
  Index& unknown = events.back().node.stability.unknown_directions;
  unknown = std::max(unknown, before.stability.unknown_directions);
  return true;
}

/// How far from an event its place is uncertain. Where a path crosses another one at which its
/// factor turns, an eigenvalue vanishes with the square of the distance, so that the inertia and
/// the sense of the tangent are round-off within the square root of the rounding error.
double EventLocator::reach_of(const LocatedEvent& event, const PathNode& start) {
  double reach = kOnePlace * largest_step_;
  while (reach < kFarthestReach * largest_step_ &&
         (equations_.is_singular(start, event.step - reach) ||
          equations_.is_singular(start, event.step + reach))) {
    reach *= 2.0;
  }
  return reach;
}

void EventLocator::merge(std::vector<LocatedEvent>& events, const PathNode& start) {
  std::vector<LocatedEvent> merged;
  for (LocatedEvent& event : events) {
    event.reach = reach_of(event, start);
    if (merged.empty() || event.step - merged.back().step > event.reach) {
      merged.push_back(std::move(event));
      continue;
    }
    LocatedEvent& place = merged.back();
    place.factor_turns = place.factor_turns != event.factor_turns;
    place.lost_directions += event.lost_directions;
    place.reach = std::max(place.reach, event.reach);
    place.node = std::move(event.node);
  }
  for (LocatedEvent& event : merged) {
    // The tangent cannot be computed at a bifurcation, where the stiffness is singular.
    if (event.event() == PathEvent::Bifurcation) event.node.tangent = start.tangent;
  }
  events = std::move(merged);
}

}  // namespace der::statics
