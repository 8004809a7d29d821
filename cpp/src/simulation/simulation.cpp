#include "der/simulation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "der/assembly/structure.hpp"
#include "der/building/builder.hpp"
#include "der/building/out_of_plane_model.hpp"
#include "der/core/error.hpp"
#include "der/core/loops.hpp"
#include "der/model/location.hpp"
#include "der/scenario/out_of_plane.hpp"
#include "der/scenario/scenario.hpp"
#include "der/solvers/joint_rotations.hpp"
#include "der/supports/bearing.hpp"
#include "simulation/stepper_options.hpp"

namespace der {
namespace {

/// The first value that is not a finite number, in words with the way out; empty if there is none.
std::string find_nonfinite(const Model& model, const Vector& values, const char* what,
                           const char* way_out) {
  // Zero times infinity is not a number. Faster than looking at each.
  if ((0.0 * values).sum() == 0.0) return {};
  Index dof = 0;
  while (std::isfinite(values[dof])) ++dof;
  return fmt::format("{} of {} is {}, not a finite number: {}", what, describe_dof(model, dof),
                     values[dof], way_out);
}

/// Every name with what it stands for: that of each control, and those of its components.
std::map<std::string, Simulation::Settable, std::less<>> settable_in(const Model& model) {
  std::map<std::string, Simulation::Settable, std::less<>> all;
  for (const NamedControl& control : model.named) {
    const ControlComponent* const begin = control.components.data();
    const ControlComponent* const end = begin + control.components.size();
    all[control.name] = {&control, begin, end};
    for (const ControlComponent* each = begin; each != end; ++each) {
      all[control.name + "." + each->name] = {&control, each, each + 1};
    }
  }
  return all;
}

/// A support in which a planar rod would spin if it left its plane, in words; empty if there is
/// none.
std::string find_spin_inside(const scenario::Scene& scene, const Model& model) {
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    const scenario::Support& support = scene.supports[i];
    const RodMesh& rod = model.rod(support.rod);
    if (support.clamp != scenario::Clamp::Tangent || rod.EI == 0.0) continue;
    for (const Index place : nodes_at(support.at, rod)) {
      if (!lets_spin_inside(support, place, rod)) continue;
      return fmt::format("supports.{} lets rod '{}' spin within it ('clamp: tangent')", i,
                         rod.name);
    }
  }
  return {};
}

std::string why_not_tested_out_of_plane(const scenario::Scene& scene, const Model& model) {
  if (model.dimension != 2) return {};
  std::string why_not = scenario::why_not_tested_out_of_plane(scene);
  if (why_not.empty()) why_not = find_spin_inside(scene, model);
  if (why_not.empty() && is_held_out_of_plane(scene, model)) {
    why_not = "supports hold every node there, and no section can twist";
  }
  return why_not;
}

}  // namespace

Simulation::Constants::Constants(Scenario scene)
    : scenario(std::move(scene)),
      model(build_model(scenario.scene())),
      settable(settable_in(model)),
      not_tested(why_not_tested_out_of_plane(scenario.scene(), model)) {}

std::shared_ptr<const Simulation::Constants> Simulation::constants_like(Scenario scenario,
                                                                        const Simulation& like) {
  if (&scenario.scene() == &like.scenario().scene()) return like.constants_;
  auto constants = std::make_shared<const Constants>(std::move(scenario));
  const std::string difference = structural_difference(constants->model, like.model_);
  if (!difference.empty()) {
    throw Error(
        "model_error",
        fmt::format("only numbers of a scene may differ, not its structure: {}", difference));
  }
  return constants;
}

std::shared_ptr<const Assembler> Simulation::assembler_like(const Simulation* like) const {
  const MatrixLayout& layout = solver_.solver->layout();
  if (like == nullptr || !layout.same_slots(like->solver_.solver->layout())) {
    return std::make_shared<const Assembler>(model_, layout);
  }
  return constants_ == like->constants_
             ? like->assembler_
             : std::make_shared<const Assembler>(model_, *like->assembler_);
}

Simulation::Simulation(Scenario scenario)
    : Simulation(std::make_shared<const Constants>(std::move(scenario)), nullptr) {}

Simulation::Simulation(Scenario scenario, const Simulation& like)
    : Simulation(constants_like(std::move(scenario), like), &like) {}

Simulation::Simulation(std::shared_ptr<const Constants> constants, const Simulation* like)
    : constants_(std::move(constants)),
      scenario_(constants_->scenario),
      model_(constants_->model),
      elongation_limits_(model_),
      turning_limits_(model_),
      pattern_(like != nullptr ? like->pattern_
                               : std::make_shared<const Pattern>(build_pattern(model_))),
      solver_(make_linear_solver(
          scenario_.scene().solver.linear, *pattern_,
          scenario_.scene().is_dynamic() ? Elimination::FromBothEnds : Elimination::FromStart)),
      assembler_(assembler_like(like)),
      stepper_info_(find_stepper(scenario_.scene().time.integrator)),
      stepper_(make_stepper(stepper_info_.name, model_, *assembler_, *solver_.solver,
                            stepper_options(scenario_.scene()))),
      energy_monitor_(model_),
      support_motion_(model_),
      horizon_(scenario_.scene().time.duration),
      state_(initial_state(model_)) {
  loops();  // refuses a wrong DER_LOOPS here, and not as the failure of a step
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
        model_, *assembler_, *stepper_, stepper_info_,
        AdaptiveOptions{time.tolerance, time.duration, time.minimum_step, plan_.largest_step});
  }
}

void Simulation::start_anew() {
  settle_rotations(JointRotations::Which::Undamped);
  forget_steps(state_);
  start_ledger(model_, state_);
  energy_monitor_.begin(state_);
}

void Simulation::settle_rotations(JointRotations::Which which) {
  if (!model_.has_rotations() || !find_nonfinite().empty()) return;
  Configuration here;
  evaluate_controls(model_, state_, state_.time, here.controls);
  JointRotations rotations(model_);
  rotations.settle(here.controls, state_.extra_force, state_.positions, which);
  if (model_.has_sections()) der::follow(model_, state_);
  here.coordinates = state_.positions;
  rotations.set_rates(here, state_.extra_force, state_.velocities);
}

std::string Simulation::find_nonfinite() const {
  const auto find_in = [this](const Vector& values, const char* what) {
    return der::find_nonfinite(model_, values, what, way_out_);
  };
  std::string found = find_in(state_.positions, "the position");
  if (found.empty()) found = find_in(state_.extra_force, "the extra force");
  if (found.empty()) found = find_in(state_.velocities, "the velocity");
  return found;
}

void Simulation::check_finite_state() const {
  if (const std::string found = find_nonfinite(); !found.empty()) throw Error("model_error", found);
}

State Simulation::save() {
  if (find_nonfinite().empty()) {
    enter_writes();
    energy_monitor_.begin(state_);
  }
  return state_;
}

void Simulation::restore(const State& saved) {
  check_state(model_, saved);
  // Vectors of the same length keep their memory when assigned.
  state_ = saved;
  energy_monitor_.begin(state_);
}

}  // namespace der
