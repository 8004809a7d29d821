// Equilibria, modes, buckling and paths, and the derivatives of the potential.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "der/core/error.hpp"
#include "der/energies/registry.hpp"
#include "der/loads/external_force.hpp"
#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"
#include "simulation/stepper_options.hpp"
#include "simulation/undo.hpp"

namespace der {

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
  if (!model_.elements->has_potential()) {
    throw Error("model_error",
                "loads that turn with the rod, and moments in space, have no potential: there are "
                "no vibration modes with real frequencies to be sure of. A run over time shows "
                "whether vibrations grow");
  }
  constexpr double kBalanced = 1e-6;
  const Forces now = forces();
  Stiffness stiffness(model_, assembler_, *solver_.solver);
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
    throw Error("model_error",
                "nothing varies along the path: the forces, moments and motions that its load "
                "factor scales are "
                "all zero");
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
  state_.followed = point.followed;
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

}  // namespace der
