#include "der/steppers/adaptive_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "der/core/index.hpp"
#include "der/model/edge_change.hpp"

namespace der {
namespace {

// Parameters of the step size controller.
constexpr double kSafety = 0.9;
constexpr double kProportional = 0.4;
constexpr double kIntegral = 0.7;
constexpr double kLeastFactor = 0.2;
constexpr double kGreatestFactor = 2.0;
/// After a step that did not converge.
constexpr double kRetryFactor = 0.25;
/// Differences below this fraction of the positions are not significant: they come from rounding
/// and from the tolerance of Newton's method.
constexpr double kInsignificant = 1e-14;
/// Share of its length by which the ends of an edge may be off against each other, gathered over
/// the duration. An edge that is shorter than the tolerance could otherwise turn over within it.
constexpr double kEdgeError = 0.5;
/// [rad] Greatest error of the angle of a section in one step, so that no step mistakes its turns.
/// It is not gathered: over the duration an angle counts as the motion of the section's material.
constexpr double kAngleError = 0.5;
/// If the remainder would be shorter than this fraction of the step, the step is extended to the
/// end.
constexpr double kSliver = 1e-9;

std::vector<double> table_entries(const Model& model) {
  std::vector<double> times;
  for (const scenario::Series& series : model.tables.all()) {
    times.insert(times.end(), series.times.begin(), series.times.end());
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

double shortest_edge(const Model& model) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Edge& edge : model.edges) shortest = std::min(shortest, edge.rest_length);
  return shortest;
}

/// Whether nothing holds the sections of a rod against spinning as a whole.
bool spins(const RodMesh& rod) {
  return std::none_of(rod.clamps.begin(), rod.clamps.end(),
                      [](const Clamp& clamp) { return clamp.holds_section; }) &&
         std::none_of(rod.section_springs.begin(), rod.section_springs.end(),
                      [](const SectionSpringPlace& place) { return place.stiffness.z() > 0.0; }) &&
         std::none_of(rod.legs.begin(), rod.legs.end(), [](const Leg& leg) {
           return leg.start.rotation >= 0 || leg.end.rotation >= 0;
         });
}

/// Scales the angles in `difference` so that they count as the section's radius of gyration times
/// the angle, and not as the model's size times it. That is how far the material moves, and, about
/// a stable shape, in the mean over the mass as far as the angle can ever move nodes: a vibration
/// cos(W t) d, W^2 = M^-1 K, is never longer than d in the norm of M. Where nothing brings a rod
/// back that has turned as a whole, its mean angle stays as it is: a bend makes it a motion of the
/// nodes. The result is the largest of the angles [rad].
double count_turns_as_motion(const Model& model, Vector& difference) {
  if (model.framed_edges.empty()) return 0.0;
  const Vector& mass = model.mass.lumped;
  const double size = model.dofs.length();
  double largest = 0.0;
  for (const RodMesh& rod : model.rods) {
    const auto edges = [&](const auto& use) {
      for (Index k = 0; k < rod.num_edges(); ++k)
        use(model.framed_edges[to_size(rod.first_edge + k)]);
    };
    double whole = 0.0;
    double inertia = 0.0;
    if (spins(rod)) {
      edges([&](const SpatialEdge& edge) {
        whole += mass[edge.theta] * difference[edge.theta];
        inertia += mass[edge.theta];
      });
    }
    const double mean = inertia > 0.0 ? whole / inertia : 0.0;
    edges([&](const SpatialEdge& edge) {
      double& angle = difference[edge.theta];
      largest = std::max(largest, std::abs(angle));
      const double radius =
          std::sqrt(mass[edge.theta] / (0.5 * (mass[edge.start] + mass[edge.end])));
      angle = mean + (angle - mean) * std::min(radius / size, 1.0);
    });
  }
  return largest;
}

/// With steps no longer than see every sine swing.
AdaptiveOptions resolving_sines(AdaptiveOptions options, const Model& model) {
  for (const scenario::Series& series : model.tables.all()) {
    options.largest_step = std::min(options.largest_step, longest_resolving_step(series.course));
  }
  return options;
}

}  // namespace

AdaptiveStepper::AdaptiveStepper(const Model& model, const Assembler& assembler, Stepper& stepper,
                                 const StepperInfo& info, const AdaptiveOptions& options)
    : model_(model),
      stepper_(stepper),
      order_(info.order),
      error_factor_(info.error_factor),
      options_(resolving_sines(options, model)),
      breakpoints_(table_entries(model)),
      shortest_edge_(shortest_edge(model)),
      support_motion_(model),
      start_(initial_state(model)),
      middle_(start_),
      whole_(start_),
      dense_(model, assembler) {}

AdaptiveReport AdaptiveStepper::advance(State& state, double horizon) {
  AdaptiveReport report;
  start_ = state;
  const double stop = next_stop(state, horizon);
  const double longest = support_motion_.longest_step(state);
  double wanted = wanted_step(state);
  while (true) {
    wanted = std::min({std::max(wanted, options_.minimum_step), options_.largest_step, longest});
    const double left = stop - start_.time;
    // This avoids a very short last step.
    const bool last = wanted >= left * (1.0 - kSliver);
    const double length = last ? left : std::min(wanted, 0.5 * left);
    report.tried = length;
    report.last = attempt(state, length);
    report.newton_iterations += report.last.newton_iterations;

    double factor = kRetryFactor;
    if (report.last.outcome == StepOutcome::Done) {
      measure(state, report);
      const double error = report.error;
      factor = error > 0.0 ? kSafety * std::pow(error, -1.0 / order_) : kGreatestFactor;
      if (error <= 1.0) {
        if (error > 0.0 && start_.last_error > 0.0) {
          factor = kSafety * std::pow(error, -kIntegral / order_) *
                   std::pow(start_.last_error, kProportional / order_);
        }
        // After a rejection the step does not grow at once.
        const double most = report.rejected > 0 ? 1.0 : kGreatestFactor;
        state.time = last ? stop : start_.time + length;
        state.last_error = error;
        longest_step_ = std::max(longest_step_, length);
        // A step cut short by a stop says little about the next one.
        const double base = last && length < wanted ? wanted : length;
        state.next_step = base * std::clamp(factor, kLeastFactor, most);
        return report;
      }
      report.last.outcome = StepOutcome::TooInaccurate;
    }
    ++report.rejected;
    state = start_;
    wanted = length * std::clamp(factor, kLeastFactor, 0.5 + 0.5 * kSafety);
    if (wanted < options_.minimum_step) return report;
  }
}

/// Sets `state` to the end of two halves, keeping the middle and the end of the whole step.
StepReport AdaptiveStepper::attempt(State& state, double length) {
  whole_ = start_;
  StepReport report = stepper_.step(whole_, length);
  for (int half = 0; half < 2 && report.outcome == StepOutcome::Done; ++half) {
    if (half == 1) {
      state.time = start_.time + 0.5 * length;
      middle_ = state;
    }
    const int iterations = report.newton_iterations;
    report = stepper_.step(state, 0.5 * length);
    report.newton_iterations += iterations;
  }
  return report;
}

/// Compares the two halves that led to `state` with the whole step.
void AdaptiveStepper::measure(const State& state, AdaptiveReport& report) {
  difference_ = whole_.positions - state.positions;
  const double angle = count_turns_as_motion(model_, difference_);
  const double change = largest_edge_change(model_, difference_);
  const Index worst = model_.dofs.most_moved(difference_);
  const double difference = model_.dofs.motion_of(worst, difference_[worst]);
  report.last.worst_dof = worst;
  const double rounding = kInsignificant * model_.dofs.largest_motion(state.positions);
  const double of_position = difference / (options_.tolerance * model_.size());
  const double of_edge = change * shortest_edge_ <= rounding ? 0.0 : change / kEdgeError;
  const double share = report.tried / options_.duration;
  const double gathered = std::max(of_position, of_edge) / share;
  report.error = error_factor_ * std::max(gathered, angle / kAngleError);
  report.is_of_edge = of_edge > of_position;
  report.at_rounding = difference <= rounding;
}

/// The time in which the motion covers a distance of the tolerance; from rest a small fraction of
/// the duration. A step that is too long is rejected, which costs little.
double AdaptiveStepper::first_step(const State& state) const {
  const double distance = options_.tolerance * model_.size();
  const double speed = model_.dofs.largest_motion(state.velocities);
  const double longest = options_.duration / 100.0;
  return speed > 0.0 ? std::min(longest, distance / speed) : 1e-2 * longest;
}

double AdaptiveStepper::wanted_step(const State& state) const {
  return state.next_step > 0.0 ? state.next_step : first_step(state);
}

double AdaptiveStepper::end_of_next_step(const State& state, double horizon) const {
  const double wanted = std::max(wanted_step(state), options_.minimum_step);
  return std::min(state.time + std::min(wanted, options_.largest_step), next_stop(state, horizon));
}

double AdaptiveStepper::next_stop(const State& state, double horizon) const {
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon();
  const double time = state.time;
  const double later = time + rounding * std::max(options_.duration, std::abs(time));
  const auto next = std::upper_bound(breakpoints_.begin(), breakpoints_.end(), later);
  double stop = next == breakpoints_.end() ? horizon : std::min(horizon, *next);
  for (const Ramp& ramp : state.ramps) {
    if (ramp.end > later) stop = std::min(stop, ramp.end);
  }
  return stop;
}

void AdaptiveStepper::interpolate(double time, const State& state, State& result) {
  const bool first = time <= middle_.time;
  dense_.evaluate(time, first ? start_ : middle_, first ? middle_ : state, result);
}

}  // namespace der
