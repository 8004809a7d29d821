#include "der/simulation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "der/building/builder.hpp"
#include "der/building/out_of_plane_model.hpp"
#include "der/core/error.hpp"
#include "der/scenario/out_of_plane.hpp"
#include "der/scenario/scenario.hpp"
#include "simulation/stepper_options.hpp"

namespace der {
namespace {

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

std::string why_not_tested_out_of_plane(const scenario::Scene& scene, const Model& model) {
  if (model.dimension != 2) return {};
  std::string why_not = scenario::why_not_tested_out_of_plane(scene);
  if (why_not.empty() && is_held_out_of_plane(scene, model)) {
    why_not = "supports hold every node there, and no section can twist";
  }
  return why_not;
}

}  // namespace

Simulation::Simulation(Scenario scenario)
    : scenario_(std::move(scenario)),
      model_(build_model(scenario_.scene())),
      settable_(settable_in(model_)),
      pattern_(build_pattern(model_)),
      solver_(make_linear_solver(
          scenario_.scene().solver.linear, pattern_,
          scenario_.scene().is_dynamic() ? Elimination::FromBothEnds : Elimination::FromStart)),
      assembler_(model_, solver_.solver->layout()),
      not_tested_(why_not_tested_out_of_plane(scenario_.scene(), model_)),
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

void Simulation::start_anew() {
  forget_steps(state_);
  start_ledger(model_, state_);
  energy_watch_.begin(state_);
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

void Simulation::restore(const State& saved) {
  check_state(model_, saved);
  // Vectors of the same length keep their memory when assigned.
  state_ = saved;
  energy_watch_.begin(state_);
}

}  // namespace der
