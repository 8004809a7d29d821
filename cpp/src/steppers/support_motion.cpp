#include "der/steppers/support_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "der/supports/clamp.hpp"

namespace der {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kLargestTurn = 1.0;  // [rad]

/// Sums up how far a value moves along straight pieces.
class Odometer {
 public:
  explicit Odometer(double limit) : left_(limit) {}
  /// The time at which the limit is reached, on the way from one time and value to others.
  double time_of_limit(double start, double from, double end, double to) {
    const double change = std::abs(to - from);
    if (change > left_) return start + (end - start) * (left_ / change);
    left_ -= change;
    return kNever;
  }

 private:
  double left_;
};

double time_of_limit(const Ramp& ramp, double limit, double time) {
  if (time >= ramp.end) return kNever;
  return Odometer(limit).time_of_limit(std::max(time, ramp.start), ramp.at(time), ramp.end,
                                       ramp.to);
}

double time_of_limit(const scenario::Series& series, double limit, double time) {
  Odometer odometer(limit);
  double before = time;
  double from = value_at(series, time);
  const auto later = std::upper_bound(series.times.begin(), series.times.end(), time);
  for (auto entry = later; entry != series.times.end(); ++entry) {
    const double to = series.values[static_cast<std::size_t>(entry - series.times.begin())];
    const double reached = odometer.time_of_limit(before, from, *entry, to);
    if (reached < kNever) return reached;
    before = *entry;
    from = to;
  }
  return kNever;
}

/// Length [m] of the shortest edge that ends at a degree of freedom's node.
double shortest_edge_at(Index dof, const Model& model) {
  const Index node = model.dof(model.dofs.node_of(dof), 0);
  double shortest = kNever;
  for (const Edge& edge : model.edges) {
    if (edge.first != node && edge.last != node) continue;
    shortest = std::min(shortest, edge.rest_length);
  }
  return shortest;
}

}  // namespace

SupportMotion::SupportMotion(const Model& model) : model_(model) {
  for (const HeldDof& held : model.held) {
    if (held.displacement < 0) continue;
    moved_.push_back({held.displacement, shortest_edge_at(held.dof, model)});
  }
  for (const RodLayout& rod : model.rods) {
    for (const Clamp& clamp : rod.clamps) {
      for_each_turning_control(clamp,
                               [&](Index control) { moved_.push_back({control, kLargestTurn}); });
    }
  }
}

double SupportMotion::time_of(double strips, const State& state) const {
  double earliest = kNever;
  for (const auto& [control, strip] : moved_) {
    const auto ramp =
        std::find_if(state.ramps.begin(), state.ramps.end(),
                     [index = control](const Ramp& other) { return other.control == index; });
    const double limit = strips * strip;
    earliest = std::min(earliest, ramp == state.ramps.end()
                                      ? time_of_limit(model_.tables[control], limit, state.time)
                                      : time_of_limit(*ramp, limit, state.time));
  }
  return earliest - state.time;
}

}  // namespace der
