// The steps of a run over time: equal, adaptive, and in pieces.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "der/core/error.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"
#include "der/statics/written_shape.hpp"
#include "der/supports/written_turns.hpp"
#include "simulation/undo.hpp"

namespace der {
namespace {

/// Pieces of a step that differ by no more than this share are of one length.
constexpr double kSameLength = 1e-9;
/// Supports that move farther in a step, in edges or radians, are a mistake.
constexpr double kMostStrips = 1e4;

/// A held node that a program has written farther from its support than this share of the shortest
/// edge is told: a step takes it back at once.
constexpr double kAwayFromSupport = 0.01;

/// Explicit steps as long as nine tenths of the stable one give the fastest motion an energy that
/// swings by 1/(1 - 0.9^2) times what it has, without growing: that is doubtful, but no failure.
constexpr double kLargestSwing = 5.0;

bool is_unstable(const EnergyAudit& audit, const StepperInfo& stepper) {
  return is_unstable(audit) &&
         (stepper.implicit || audit.created > kLargestSwing * audit.exchanged);
}

/// The longest length up to `longest` of which `whole` is a multiple.
double even_piece(double whole, double longest) {
  return whole / std::max(1.0, std::ceil(whole / longest * (1.0 - kSameLength)));
}

}  // namespace

bool Simulation::finished() const { return state_.time >= plan_.duration; }

void Simulation::check_first_step() {
  if (stability_) stability_->check_start(state_);
}

void Simulation::step() {
  if (!scenario_.scene().is_dynamic()) {
    throw Error("model_error", "a static scene has no time steps: use equilibrium()");
  }
  Undo undo(state_, before_step_);
  if (const std::string found = find_nonfinite(); !found.empty()) throw DivergedError(found);
  check_rest_shape();
  enter_writes();
  const bool was_finished = finished();
  if (adaptive_) {
    advance_adaptively();
  } else {
    advance_to(next_time());
  }
  ++state_.step;
  ++counters_.steps;
  undo.keep();
  energy_monitor_.after_step(state_);
  if (is_audit_due(was_finished)) watch_energy(energy_monitor_.energies_of(state_));
}

std::optional<double> Simulation::end_of_plain_step() const {
  if (adaptive_ || stability_) return std::nullopt;
  const double end = plan_.next_time(state_.time);
  const double whole = end - state_.time;
  if (!(whole > 0.0) || support_motion_.longest_step(state_) < whole) return std::nullopt;
  return end;
}

bool Simulation::enter_step(double end, int newton_iterations) {
  const bool was_finished = finished();
  state_.last_step = end - state_.time;
  state_.time = end;
  ++state_.step;
  ++counters_.steps;
  counters_.newton_iterations += newton_iterations;
  return is_audit_due(was_finished);
}

void Simulation::enter_writes() {
  if (!energy_monitor_.has_external_writes(state_)) return;
  const double before = energy_monitor_.energy_before_writes(state_);
  if (energy_monitor_.has_written_shape(state_)) {
    warn_of_held_nodes();
    follow_written_shape(state_, {});
    settle_rotations();
  }
  energy_monitor_.enter_written(before, state_);
}

void Simulation::warn_of_held_nodes() {
  if (told_of_held_nodes_) return;
  Vector controls;
  evaluate_controls(model_, state_, state_.time, controls);
  Vector at_supports = state_.positions;
  apply_prescribed_motion(model_, controls, at_supports);
  const Vector away = (at_supports - state_.positions).head(model_.dofs.num_positions());
  Index worst = 0;
  const double farthest = away.cwiseAbs().maxCoeff(&worst);
  double edge = std::numeric_limits<double>::infinity();
  for (const RodMesh& rod : model_.rods) {
    edge = std::min(edge, *std::min_element(rod.edge_length.begin(), rod.edge_length.end()));
  }
  if (!(farthest > kAwayFromSupport * edge)) return;
  told_of_held_nodes_ = true;
  warnings_.push_back(fmt::format(
      "positions were written with {} at {:.4g} m, where its support has it at {:.4g} m at t = "
      "{:.6g} s: the next step takes it back there at once. Let supports arrive before you write: "
      "after prescribe, equilibrium() has them there at once and step() at its end",
      describe_dof(model_, worst), state_.positions[worst], at_supports[worst], state_.time));
}

void Simulation::follow_writes() {
  if (!model_.has_rotations() || !energy_monitor_.has_written_shape(state_)) return;
  if (!find_nonfinite().empty()) return;
  follow_written(model_, state_);
  settle_rotations();
}

void Simulation::follow_written_shape(State& state, const CancelCallback& beat) {
  for (std::string& warning :
       der::follow_written_shape(model_, *assembler_, *solver_.solver,
                                 energy_monitor_.has_written_angles(state), beat, state)) {
    warnings_.push_back(std::move(warning));
  }
}

bool Simulation::has_external_writes() const {
  return energy_monitor_.has_external_writes(state_) || !find_nonfinite().empty();
}

std::int64_t Simulation::audit_stride() const {
  return EnergyMonitor::kStride * (stepper_info_.implicit ? 1 : 4);
}

/// After a step. From rest there is nothing to compare with at first: early looks see what is
/// exchanged only.
bool Simulation::is_audit_due(bool was_finished) const {
  const std::int64_t stride = audit_stride();
  return state_.step < stride || state_.step % stride == 0 || (finished() && !was_finished);
}

void Simulation::watch_energy(const Energies& now) {
  const bool is_early = state_.step < audit_stride();
  const EnergyAudit before = state_.audit;
  energy_monitor_.enter_energies(now, state_);
  if (is_early) {
    state_.audit.created = before.created;
    state_.audit.unreliable_from = before.unreliable_from;
    return;
  }
  if (is_unstable(state_.audit, stepper_info_) && !scenario_.scene().time.allow_unstable) {
    throw DivergedError(describe_unstable_motion(), "unstable_motion");
  }
}

double Simulation::next_time() const {
  const double next = plan_.next_time(state_.time);
  if (next > state_.time) return next;
  throw Error(
      "model_error",
      fmt::format("a step of {:g} s is lost in the rounding of the time, {:g} s: go back to "
                  "a state of an earlier time",
                  plan_.step, state_.time));
}

void Simulation::advance_adaptively() {
  constexpr double endless = std::numeric_limits<double>::infinity();
  const AdaptiveReport report =
      adaptive_->advance(state_, state_.time < horizon_ ? horizon_ : endless);
  counters_.newton_iterations += report.newton_iterations;
  counters_.rejected_steps += report.rejected;
  if (report.last.outcome == StepOutcome::TooInaccurate) {
    throw NotConvergedError(describe_inaccuracy(report));
  }
  if (report.last.outcome != StepOutcome::Done) fail(report.last, report.tried);
}

void Simulation::advance_to(double target) {
  const double whole = target - state_.time;
  if (support_motion_.time_of(kMostStrips, state_) < whole) {
    throw NotConvergedError(fmt::format(
        "in the step from t = {:.6g} s a support moves by more than {:g} of its edges, or turns by "
        "more than as many radians: look at the numbers and units of 'prescribe', or take a "
        "smaller time.step",
        state_.time, kMostStrips));
  }
  double dt = whole;
  int pieces = 0;
  while (true) {
    const double left = target - state_.time;
    if (stability_) dt = stable_piece(left, whole, dt);
    const double piece = std::min(dt, even_piece(left, support_motion_.longest_step(state_)));
    const bool last = piece >= left * (1.0 - kSameLength);
    const double tried = last ? left : piece;
    if (++pieces == 2) ++counters_.retried_steps;
    const StepReport report = stepper_->step(state_, tried);
    counters_.newton_iterations += report.newton_iterations;
    if (report.outcome == StepOutcome::Done) {
      state_.time = last ? target : state_.time + tried;
      if (last) return;
      continue;
    }
    if (report.outcome == StepOutcome::Diverged) fail(report, tried);
    dt = 0.5 * tried;
    if (dt < scenario_.scene().time.minimum_step) fail(report, tried);
  }
}

/// The piece of a step `whole` [s] that an explicit stepper does next, of what is left of it, where
/// the last one was `dt`. Within a step pieces only get shorter.
double Simulation::stable_piece(double left, double whole, double dt) {
  stability_->look(state_, plan_.step);
  const double wanted = state_.next_step;
  if (wanted == 0.0 || dt <= wanted * (1.0 + kSameLength)) return dt;
  const double piece = even_piece(left, wanted);
  const auto pieces = static_cast<std::int64_t>(std::ceil(whole / piece * (1.0 - kSameLength)));
  counters_.most_pieces = std::max(counters_.most_pieces, pieces);
  return piece;
}

void Simulation::fail(const StepReport& report, double dt) {
  if (report.outcome == StepOutcome::Diverged) throw DivergedError(describe_divergence(report, dt));
  throw NotConvergedError(describe_failure(report, dt));
}

}  // namespace der
