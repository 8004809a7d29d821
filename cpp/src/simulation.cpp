#include "der/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "der/building/builder.hpp"
#include "der/core/error.hpp"
#include "der/loads/external_force.hpp"
#include "der/scenario/scenario.hpp"

namespace der {
namespace {

/// Newton's error must not show in the estimated error of a step, which is a small part of the
/// tolerance.
constexpr double kNewtonShare = 1e-5;
/// Pieces of a step that differ by no more than this share are of one length.
constexpr double kSameLength = 1e-9;
/// Supports that move farther in a step, in edges or radians, are a mistake.
constexpr double kMostStrips = 1e4;

StepperOptions stepper_options(const scenario::Scene& scene) {
  StepperOptions options;
  options.newton = {scene.solver.residual_tolerance, scene.solver.step_tolerance,
                    scene.solver.max_iterations};
  if (scene.time.stepping == scenario::Stepping::Adaptive) {
    options.newton.step_tolerance =
        std::min(options.newton.step_tolerance, kNewtonShare * scene.time.tolerance);
  }
  options.spectral_radius = scene.time.spectral_radius;
  return options;
}

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

/// Puts a state back to what it was when this was made, unless the change of it is kept.
class Undo {
 public:
  /// `before` keeps its memory from one time to the next.
  Undo(State& state, State& before) : state_(state), before_(before) { before_ = state_; }
  ~Undo() {
    if (!kept_) state_ = before_;
  }
  Undo(const Undo&) = delete;
  Undo& operator=(const Undo&) = delete;
  void keep() { kept_ = true; }

 private:
  State& state_;
  State& before_;
  bool kept_ = false;
};

/// The first control that moves this component; Error if the scene prescribes none.
const PrescribedControl& check_prescribed(const Model& model, std::size_t support,
                                          const std::string& component) {
  std::string known;
  for (const PrescribedControl& candidate : model.prescribed) {
    if (candidate.support == support && candidate.component == component) return candidate;
    const std::string name =
        fmt::format("{} of support {}", candidate.component, candidate.support);
    if (known.find(name) == std::string::npos) known += (known.empty() ? "" : ", ") + name;
  }
  throw Error(
      "model_error",
      fmt::format("the scene does not prescribe {} of support {} (counted from 0): give that "
                  "support 'prescribe: {{{}: 0}}'; it prescribes {}",
                  component, support, component, known.empty() ? "nothing" : known));
}

/// The first value that is not a finite number, in words; empty if there is none.
std::string find_nonfinite(const Model& model, const Vector& values, const std::string& what) {
  if (values.allFinite()) return {};
  Index dof = 0;
  while (std::isfinite(values[dof])) ++dof;
  return fmt::format(
      "{} of {} is {}, not a finite number: write one there, or begin again with a "
      "new simulation",
      what, describe_dof(model, dof), values[dof]);
}

}  // namespace

Simulation::Simulation(Scenario scenario)
    : scenario_(std::move(scenario)),
      model_(build_model(scenario_.scene())),
      pattern_(build_pattern(model_)),
      solver_(make_linear_solver(scenario_.scene().solver.linear, pattern_)),
      assembler_(model_, solver_.solver->layout()),
      stepper_info_(find_stepper(scenario_.scene().time.integrator)),
      stepper_(make_stepper(stepper_info_.name, model_, assembler_, *solver_.solver,
                            stepper_options(scenario_.scene()))),
      energy_watch_(model_),
      support_motion_(model_),
      horizon_(scenario_.scene().time.duration),
      state_(initial_state(model_)) {
  start_anew();
  const scenario::Scene& scene = scenario_.scene();
  const scenario::Time& time = scene.time;
  double stable_step = std::numeric_limits<double>::infinity();
  if (scene.is_dynamic() && !stepper_info_.implicit) {
    stability_.emplace(model_, stepper_info_, time);
    stable_step = stability_->stable_step(state_);
    if (scene.start_from.empty()) check_first_step();
  }
  plan_ = plan_steps(scene, stable_step);
  if (time.stepping == scenario::Stepping::Adaptive) {
    adaptive_.emplace(
        model_, assembler_, *stepper_, stepper_info_,
        AdaptiveOptions{time.tolerance, time.duration, time.minimum_step, plan_.largest_step});
  }
}

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
  follow_turns(model_, state_.positions, state_.turns);  // a program may have moved the rods
  const bool was_finished = finished();
  energy_watch_.before_step(state_);
  if (adaptive_) {
    advance_adaptively();
  } else {
    advance_to(next_time());
  }
  ++state_.step;
  ++counters_.steps;
  undo.keep();
  energy_watch_.after_step(state_);
  watch_energy(finished() && !was_finished);
}

void Simulation::start_anew() {
  forget_steps(state_);
  start_ledger(model_, state_);
  energy_watch_.begin(state_);
}

void Simulation::watch_energy(bool at_end) {
  const std::int64_t stride = EnergyWatch::kStride * (stepper_info_.implicit ? 1 : 4);
  // From rest there is nothing to compare with at first: early looks see what is exchanged only.
  const bool is_early = state_.step < stride;
  if (!is_early && !at_end && state_.step % stride != 0) return;
  const EnergyAudit before = state_.audit;
  energy_watch_.look(state_);
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

void Simulation::prescribe(std::size_t support, const std::string& component, double value) {
  check_prescribed(model_, support, component);
  if (adaptive_) {
    throw Error("model_error",
                "supports are moved from step to step, which takes steps of one length: give the "
                "scene a time.step in place of its tolerance");
  }
  if (!std::isfinite(value)) {
    throw Error("model_error",
                fmt::format("support {}: {} must be finite, got {}", support, component, value));
  }
  const bool steps = scenario_.scene().is_dynamic();
  for (const PrescribedControl& moved : model_.prescribed) {
    if (moved.support != support || moved.component != component) continue;
    const double now = control_value(model_, state_, moved.control);
    const Ramp ramp{moved.control, state_.time, steps ? next_time() : state_.time, now, value};
    const auto known =
        std::find_if(state_.ramps.begin(), state_.ramps.end(),
                     [&](const Ramp& earlier) { return earlier.control == moved.control; });
    if (known == state_.ramps.end()) {
      state_.ramps.push_back(ramp);
    } else {
      *known = ramp;
    }
  }
}

double Simulation::prescribed(std::size_t support, const std::string& component) const {
  const PrescribedControl& found = check_prescribed(model_, support, component);
  return control_value(model_, state_, found.control);
}

std::string Simulation::find_nonfinite() const {
  std::string found = der::find_nonfinite(model_, state_.positions, "the position");
  if (found.empty()) found = der::find_nonfinite(model_, state_.extra_force, "the extra force");
  if (found.empty()) found = der::find_nonfinite(model_, state_.velocities, "the velocity");
  return found;
}

void Simulation::check_finite_state() const {
  if (const std::string found = find_nonfinite(); !found.empty()) throw Error("model_error", found);
}

EquilibriumReport Simulation::equilibrium(bool leave_saddles) {
  check_finite_state();
  State found = state_;
  for (Ramp& ramp : found.ramps) ramp.from = ramp.to;
  EquilibriumOptions options;
  options.newton = stepper_options(scenario_.scene()).newton;
  // Solved once, not at every step: one more iteration takes the last digits too.
  options.newton.step_tolerance *= 0.01;
  options.leave_saddles = leave_saddles;
  EquilibriumReport report = find_equilibrium(model_, assembler_, *solver_.solver, options, found);
  counters_.newton_iterations += report.newton_iterations;
  if (report.failed) {
    throw NotConvergedError(
        fmt::format("no stable equilibrium found: {}. {}", message_of(*report.failed),
                    advice_for(report.failed->cause)),
        status_of(report.failed->cause));
  }
  found.velocities.setZero();
  state_ = std::as_const(found);  // copied, not moved: views of the vectors stay valid
  start_anew();
  return report;
}

std::vector<Mode> Simulation::modes(int count) {
  check_finite_state();
  constexpr double kBalanced = 1e-6;
  const Forces now = forces();
  Stiffness stiffness(model_, assembler_, *solver_.solver);
  stiffness.evaluate(now.here);
  const double unbalanced = now.unbalanced(model_).lpNorm<Eigen::Infinity>();
  const double acting =
      std::max(now.gradient.lpNorm<Eigen::Infinity>(), now.external.lpNorm<Eigen::Infinity>());
  if (unbalanced > kBalanced * acting + stiffness.rounding() * model_.size) {
    throw Error("model_error",
                fmt::format("vibration modes are those of an equilibrium, but {:.3g} N are not in "
                            "balance here: call equilibrium() first",
                            unbalanced));
  }
  return vibration_modes(model_, assembler_, *solver_.solver, now.here, count);
}

LinearBuckling Simulation::buckling(int count) {
  if (!std::holds_alternative<scenario::BucklingAnalysis>(scenario_.scene().analysis)) {
    throw Error("model_error", "the scene asks for no buckling loads: write 'analysis: buckling'");
  }
  State before;
  Undo undo(state_, before);
  state_.load_factor = 0.0;
  equilibrium();
  LinearBuckling result = linear_buckling(model_, assembler_, *solver_.solver, state_, count);
  state_.load_factor = 1.0;
  undo.keep();
  return result;
}

std::vector<PathBranch> Simulation::follow() {
  const auto* analysis = std::get_if<scenario::ContinuationAnalysis>(&scenario_.scene().analysis);
  if (analysis == nullptr) {
    throw Error("model_error",
                "the scene asks for no path of equilibria: write 'analysis: {continuation: {}}'");
  }
  if (!model_.load_variation->varies()) {
    throw Error("model_error", "nothing varies along the path: what it follows is zero");
  }
  State before;
  Undo undo(state_, before);
  state_.load_factor = analysis->from;
  equilibrium();
  ContinuationOptions options;
  options.newton = stepper_options(scenario_.scene()).newton;
  options.from = analysis->from;
  options.to = analysis->to;
  options.largest_step = analysis->step;
  options.max_points = analysis->points;
  options.branching = analysis->branches;
  auto path = follow_path(model_, assembler_, *solver_.solver, options, state_);
  undo.keep();
  return path;
}

void Simulation::show(const PathPoint& point, std::int64_t index) {
  state_.load_factor = point.factor;
  state_.positions = point.positions;
  state_.turns = point.turns;
  state_.step = index;
  state_.time = static_cast<double>(index);
}

Vector Simulation::Forces::unbalanced(const Model& model) const {
  return (gradient - external)(model.dofs.free());
}

Simulation::Forces Simulation::forces() const {
  Forces now;
  now.gradient.resize(model_.num_dofs());
  configuration_of(model_, state_, now.here);
  external_force(model_, now.here, state_.extra_force, now.external);
  assembler_.gradient(now.here, now.gradient);
  return now;
}

Vector Simulation::gradient() const { return forces().unbalanced(model_); }

SymmetricMatrix Simulation::hessian() const {
  const Assembler assembler(model_, MatrixLayout::compressed(pattern_));
  Vector gradient(model_.num_dofs());
  Vector values(assembler.num_values());
  assembler.gradient_and_hessian(configuration_of(model_, state_), gradient, values);
  return {pattern_, values.head(pattern_.nonzeros())};
}

SymmetricMatrix Simulation::mass() const {
  const Assembler assembler(model_, MatrixLayout::compressed(pattern_));
  Vector values = Vector::Zero(assembler.num_values());
  assembler.add_mass(model_.mass, 1.0, values);
  return {pattern_, values.head(pattern_.nonzeros())};
}

void Simulation::restore(const State& saved) {
  check_state(model_, saved);
  // Vectors of the same length keep their memory when assigned.
  state_ = saved;
  energy_watch_.begin(state_);
}

std::string Simulation::describe_failure(const StepReport& report, double dt) const {
  return fmt::format(
      "a step from t = {:.6g} s failed even with a length of {:.3g} s: {}; the worst residual is "
      "at {}. A load that rises too fast, a shape that snaps, or too tight a "
      "solver.residual_tolerance are the usual causes; a smaller time.{} or smoother load tables "
      "help.",
      state_.time, dt, report.failure, describe_dof(model_, report.worst_dof),
      adaptive_ ? "minimum_step" : "step");
}

std::string Simulation::describe_inaccuracy(const AdaptiveReport& report) const {
  const scenario::Time& time = scenario_.scene().time;
  const std::string what = fmt::format(
      "the error in time stays above the tolerance: a step of {:.3g} s from t = {:.6g} s may add "
      "its share of time.tolerance {:g}, but the error estimated at {} is {:.2g} times that",
      report.tried, state_.time, time.tolerance, describe_dof(model_, report.last.worst_dof),
      report.error);
  return what + (report.at_rounding
                     ? ". That is the rounding of positions, which no step makes smaller: raise "
                       "time.tolerance."
                     : fmt::format(". Shorter steps are below time.minimum_step of {:.3g} s: lower "
                                   "that, or raise time.tolerance.",
                                   time.minimum_step));
}

std::string Simulation::advice_on_steps() const {
  const char* shorter = "take smaller steps";
  switch (scenario_.scene().time.stepping) {
    case scenario::Stepping::Fixed:
      break;
    case scenario::Stepping::Adaptive:
      shorter = "take a smaller tolerance";
      break;
    case scenario::Stepping::Automatic:
      shorter = "give a step that is smaller than that of 'auto'";
      break;
  }
  constexpr const char* kConserving = "energy_momentum";
  if (stepper_info_.name == kConserving) return shorter;
  return fmt::format("{}, or 'integrator: {}', which creates no energy", shorter, kConserving);
}

std::string Simulation::describe_unstable_motion() const {
  return fmt::format(
      "the motion is unstable at t = {:.6g} s: {}, and has been doubtful since t = {:.6g} s. To "
      "get a right result {}; to run on all the same, say 'allow_unstable: true' under 'time'",
      state_.time, describe(model_, state_.audit), state_.audit.unreliable_from, advice_on_steps());
}

std::string Simulation::describe_divergence(const StepReport& report, double dt) {
  return fmt::format("the motion diverged at t = {:.6g} s: {} at {}. {}", state_.time,
                     report.failure, describe_dof(model_, report.worst_dof),
                     stability_->explain_blow_up(initial_state(model_), state_, dt));
}

}  // namespace der
