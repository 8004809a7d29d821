#include "der/steppers/support_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "der/core/constants.hpp"
#include "der/supports/clamp.hpp"

namespace der {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kLargestTurn = 1.0;  // [rad]

/// Sums up how far a value moves along straight pieces.
class PathLength {
 public:
  explicit PathLength(double limit) : left_(limit) {}
  /// The distance left to the limit.
  [[nodiscard]] double left() const { return left_; }
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
  return PathLength(limit).time_of_limit(std::max(time, ramp.start), ramp.at(time), ramp.end,
                                         ramp.to);
}

/// The share of its time after which a smooth piece has done a share of its change.
double time_share(double done) {
  constexpr int halvings = 40;
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (scenario::smooth_share(middle) < done ? low : high) = middle;
  }
  return low;
}

/// How far sin(angle) moves as the angle [rad] goes from 0 to `angle`, and the angle from that.
double sine_path(double angle) {
  const double swings = std::floor(angle / kPi + 0.5);
  return 2.0 * swings + std::sin(angle - swings * kPi);
}
double sine_angle(double path) {
  const double swings = std::floor(0.5 * (path + 1.0));
  return swings * kPi + std::asin(std::clamp(path - 2.0 * swings, -1.0, 1.0));
}

double time_of_sine_limit(const scenario::Series& series, double limit, double time) {
  const double amplitude = std::abs(series.values[1]);
  if (amplitude == 0.0) return kNever;
  const double rate = 2.0 * kPi * series.course.frequency;
  const double angle = rate * time + series.course.phase;
  return time + (sine_angle(sine_path(angle) + limit / amplitude) - angle) / rate;
}

double time_of_limit(const scenario::Series& series, double limit, double time) {
  using Kind = scenario::Course::Kind;
  const auto& [times, values, course] = series;
  if (course.kind == Kind::Sine) return time_of_sine_limit(series, limit, time);
  PathLength odometer(limit);
  double before = time;
  double from = value_at(series, time);
  const auto later = std::upper_bound(times.begin(), times.end(), time);
  for (auto entry = later; entry != times.end(); ++entry) {
    const auto number = static_cast<std::size_t>(entry - times.begin());
    const double to = values[number];
    const double left = odometer.left();
    const double reached = odometer.time_of_limit(before, from, *entry, to);
    if (reached < kNever) {
      if (course.kind == Kind::Linear) return reached;
      const double start = values[number - 1];
      const double done = (from + std::copysign(left, to - from) - start) / (to - start);
      return times[number - 1] + time_share(done) * (*entry - times[number - 1]);
    }
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
  for_each_turning_control(model,
                           [&](Index control) { moved_.push_back({control, kLargestTurn}); });
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
