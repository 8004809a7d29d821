// Equilibria, modes, buckling and paths, and the derivatives of the potential.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "der/assembly/pattern.hpp"
#include "der/building/builder.hpp"
#include "der/core/error.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/loads/external_force.hpp"
#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"
#include "der/statics/written_shape.hpp"
#include "der/supports/written_turns.hpp"
#include "simulation/stepper_options.hpp"
#include "simulation/undo.hpp"

namespace der {

EquilibriumReport Simulation::equilibrium(bool leave_saddles, const CancelCallback& beat) {
  State before;
  Undo undo(state_, before);
  EquilibriumReport report = settle(leave_saddles, beat);
  if (model_.dimension == 2) {
    report.out_of_plane.emplace();
    if (OutOfPlaneTest* test = out_of_plane_test(beat)) {
      report.out_of_plane->stability = test->stability(configuration_of(model_, state_));
    } else {
      report.out_of_plane->not_tested = constants_->not_tested;
    }
  }
  undo.keep();
  return report;
}

OutOfPlaneTest* Simulation::out_of_plane_test(const CancelCallback& beat) {
  if (model_.dimension == 2 && constants_->not_tested.empty() && !out_of_plane_) {
    out_of_plane_ = std::make_unique<OutOfPlaneTest>(scenario_.scene(), model_);
  }
  if (out_of_plane_) out_of_plane_->set_beat(beat);
  return out_of_plane_.get();
}

double Simulation::growth_rate_out_of_plane(const CancelCallback& beat) {
  OutOfPlaneTest* test = out_of_plane_test(beat);
  return test == nullptr ? 0.0 : test->growth_rate(configuration_of(model_, state_));
}

OutOfPlaneBuckling Simulation::buckling_out_of_plane(const LinearBuckling& in_plane,
                                                     const CancelCallback& beat) {
  OutOfPlaneTest* test = out_of_plane_test(beat);
  if (test == nullptr) return {constants_->not_tested, {}};
  State unloaded = state_;
  unloaded.load_factor = 0.0;
  return test->buckling(configuration_of(model_, unloaded), in_plane.response);
}

EquilibriumReport Simulation::settle(bool leave_saddles, const CancelCallback& beat) {
  check_finite_state();
  State found = state_;
  const auto arrive = [&] {
    found.ramps = state_.ramps;
    for (Ramp& ramp : found.ramps) ramp.from = ramp.to;
  };
  for (Ramp& ramp : found.ramps) ramp.start = ramp.end = found.time;
  if (energy_monitor_.has_written_shape(found)) {
    follow_written_shape(found, beat);
    arrive();  // a written shape is one with the supports where they are
  }
  EquilibriumOptions options;
  options.newton = stepper_options(scenario_.scene()).newton;
  // Solved once, not at every step: one more iteration takes the last digits too.
  options.newton.step_tolerance *= 0.01;
  options.leave_saddles = leave_saddles;
  options.beat = beat;
  const int saddles_left = approach(options, found);
  EquilibriumReport report = find_equilibrium(model_, *assembler_, *solver_.solver, options, found);
  counters_.newton_iterations += report.newton_iterations;
  report.saddles_left += saddles_left;
  if (report.failed) {
    throw NotConvergedError(
        fmt::format("no {}equilibrium found: {}. {}",
                    has_potential(*model_.elements) ? "stable " : "", message_of(*report.failed),
                    advice_for(report.failed->cause)),
        status_of(report.failed->cause));
  }
  arrive();
  found.velocities.setZero();
  count_angles_from_shape(model_, found);
  state_ = std::as_const(found);  // copied, not moved: views of the vectors stay valid
  start_anew();
  return report;
}

/// The scene with legs of order 2.
struct Simulation::SecondOrder {
  explicit SecondOrder(const scenario::Scene& scene)
      : model(build_model(scene, LegOrder::Second)),
        pattern(build_pattern(model)),
        solver(make_linear_solver(scene.solver.linear, pattern, Elimination::FromStart).solver),
        assembler(model, solver->layout()) {}

  const Model model;
  const Pattern pattern;
  const std::unique_ptr<LinearSolver> solver;
  const Assembler assembler;
};

int Simulation::approach(const EquilibriumOptions& options, State& found) {
  if (!has_arcs(model_)) return 0;
  if (!second_order_) second_order_ = std::make_shared<SecondOrder>(scenario_.scene());
  State near = found;
  const EquilibriumReport report = find_equilibrium(second_order_->model, second_order_->assembler,
                                                    *second_order_->solver, options, near);
  counters_.newton_iterations += report.newton_iterations;
  if (report.failed) return 0;
  for (Ramp& ramp : near.ramps) ramp.from = ramp.to;
  found = std::move(near);
  return report.saddles_left;
}

std::vector<Mode> Simulation::modes(int count, const CancelCallback& beat) {
  check_finite_state();
  if (!has_potential(*model_.elements)) {
    throw Error("model_error",
                "loads that turn with the rod, and moments in space, have no potential: there are "
                "no vibration modes with real frequencies to be sure of. A run over time shows "
                "whether vibrations grow");
  }
  constexpr double kBalanced = 1e-6;
  const Forces now = forces();
  Stiffness stiffness(model_, *assembler_, *solver_.solver, beat);
  stiffness.evaluate(now.here);
  const double unbalanced = model_.dofs.largest_free_force(now.gradient - now.external);
  const double acting =
      std::max(model_.dofs.largest_force(now.gradient), model_.dofs.largest_force(now.external));
  if (unbalanced > kBalanced * acting + stiffness.rounding() * model_.size()) {
    throw Error("model_error",
                fmt::format("vibration modes are those of an equilibrium, but {:.3g} N are not in "
                            "balance here: call equilibrium() first",
                            unbalanced));
  }
  return vibration_modes(model_, *assembler_, *solver_.solver, now.here, count, beat);
}

LinearBuckling Simulation::buckling(int count, const CancelCallback& beat) {
  if (!std::holds_alternative<scenario::BucklingAnalysis>(scenario_.scene().analysis)) {
    throw Error("model_error", "the scene asks for no buckling loads: write 'analysis: buckling'");
  }
  State before;
  Undo undo(state_, before);
  state_.load_factor = 0.0;
  settle(true, beat);
  LinearBuckling result =
      linear_buckling(model_, *assembler_, *solver_.solver, state_, count, beat);
  state_.load_factor = 1.0;
  undo.keep();
  return result;
}

std::vector<PathBranch> Simulation::follow(const CancelCallback& beat) {
  const auto* analysis = std::get_if<scenario::ContinuationAnalysis>(&scenario_.scene().analysis);
  if (analysis == nullptr) {
    throw Error("model_error",
                "the scene asks for no path of equilibria: write 'analysis: {continuation: {}}'");
  }
  if (!model_.load_variation->varies()) {
    throw Error("model_error",
                "nothing varies along the path: the forces, moments and motions that its load "
                "factor scales are "
                "all zero");
  }
  State before;
  Undo undo(state_, before);
  state_.load_factor = analysis->from;
  const EquilibriumReport start = settle(true, beat);
  if (model_.dimension == 3 && start.stability.neutral_directions > 0) {
    throw NotConvergedError(
        fmt::format("the path has no stable start: its first equilibrium is free to move in {} "
                    "direction(s), such as the turning of a rod about its own axis; hold the "
                    "section of each rod ('clamp: true') and its nodes",
                    start.stability.neutral_directions),
        status_of(EquilibriumFailure::NotHeld));
  }
  if (start.stability.unknown_directions > 0) {
    throw NotConvergedError(
        "the path has no start whose stability is known: the rounding errors of its shortest edges "
        "hide it. Give the rods fewer nodes, or longer edges",
        status_of(EquilibriumFailure::LostInRoundoff));
  }
  ContinuationOptions options;
  options.newton = stepper_options(scenario_.scene()).newton;
  options.from = analysis->from;
  options.to = analysis->to;
  options.largest_step = analysis->step;
  options.max_points = analysis->points;
  options.branching = analysis->branches;
  options.beat = beat;
  TracedPath path =
      follow_path(model_, *assembler_, *solver_.solver, options, out_of_plane_test(beat), state_);
  counters_.newton_iterations += path.newton_iterations;
  undo.keep();
  return std::move(path.branches);
}

void Simulation::show(const PathPoint& point, std::int64_t index) {
  state_.load_factor = point.factor;
  state_.positions = point.positions;
  state_.followed = point.followed;
  state_.step = index;
  state_.time = static_cast<double>(index);
  count_angles_from_shape(model_, state_);
}

Vector Simulation::Forces::unbalanced(const Model& model) const {
  return (gradient - external)(model.dofs.free());
}

Simulation::Forces Simulation::forces() const {
  Forces now;
  now.gradient.resize(model_.num_dofs());
  configuration_of(model_, state_, now.here);
  external_force(model_, now.here, state_.extra_force, now.external);
  assembler_->gradient(now.here, now.gradient);
  return now;
}

Vector Simulation::gradient() const { return forces().unbalanced(model_); }

SymmetricMatrix Simulation::hessian() const {
  const Assembler assembler(model_, MatrixLayout::compressed(*pattern_));
  Vector gradient(model_.num_dofs());
  Vector values(assembler.num_values());
  assembler.gradient_and_hessian(configuration_of(model_, state_), gradient, values);
  return {*pattern_, values.head(pattern_->nonzeros())};
}

SymmetricMatrix Simulation::mass() const {
  const Assembler assembler(model_, MatrixLayout::compressed(*pattern_));
  Vector values = Vector::Zero(assembler.num_values());
  assembler.add_mass(model_.mass, 1.0, values);
  return {*pattern_, values.head(pattern_->nonzeros())};
}

}  // namespace der
