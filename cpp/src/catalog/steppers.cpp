#include "der/catalog/steppers.hpp"

#include "der/core/error.hpp"

namespace der {
namespace {

constexpr std::string_view kLStable = "L-stable: any step";
constexpr std::string_view kAStable = "A-stable: any step";

// The error factor is 3/(2^order - 1) where nothing else is said.

StepperInfo implicit_euler() {
  StepperInfo info;
  info.name = "implicit_euler";
  info.order = 1;
  info.error_factor = 3.0;
  info.stability = kLStable;
  info.damping = "strong, all motion";
  return info;
}

StepperInfo implicit_midpoint() {
  StepperInfo info;
  info.name = "implicit_midpoint";
  info.keeps_angular_momentum = true;
  info.stability = kAStable;
  info.damping = "none";
  return info;
}

StepperInfo energy_momentum() {
  StepperInfo info;
  info.name = "energy_momentum";
  info.keeps_angular_momentum = true;
  info.stability = kAStable;
  info.damping = "none";
  return info;
}

StepperInfo generalized_alpha() {
  StepperInfo info;
  info.name = "generalized_alpha";
  info.stability = kAStable;
  info.damping = "fast motion only, as chosen";
  return info;
}

StepperInfo newmark() {
  StepperInfo info;
  info.name = "newmark";
  info.stability = kAStable;
  info.damping = "none";
  return info;
}

StepperInfo bdf2() {
  StepperInfo info;
  info.name = "bdf2";
  // The first half goes on from a half step, as the whole step does, which makes the whole step
  // better than it would be among its like: 1.8, and more while steps grow.
  info.error_factor = 2.5;
  info.stability = kLStable;
  info.damping = "fast motion, some of the slow";
  return info;
}

StepperInfo tr_bdf2() {
  StepperInfo info;
  info.name = "tr_bdf2";
  info.step_cost = 2.0;
  info.stability = kLStable;
  info.damping = "fast motion";
  return info;
}

StepperInfo sdirk4() {
  StepperInfo info;
  info.name = "sdirk4";
  info.order = 4;
  // Stiff motion converges at order 2, so the factor is larger than 3/(2^4 - 1).
  info.error_factor = 0.7;
  info.step_cost = 5.0;
  info.stability = kLStable;
  info.damping = "fast motion";
  return info;
}

StepperInfo sdirk5() {
  StepperInfo info;
  info.name = "sdirk5";
  info.order = 5;
  // As for sdirk4.
  info.error_factor = 0.7;
  info.step_cost = 5.0;
  info.stability = kLStable;
  info.damping = "fast motion";
  return info;
}

StepperInfo verlet() {
  StepperInfo info;
  info.name = "verlet";
  info.implicit = false;
  info.keeps_angular_momentum = true;
  info.step_cost = 0.05;
  info.stability = "below the stretch and bend limit";
  info.damping = "none";
  return info;
}

StepperInfo explicit_euler() {
  StepperInfo info;
  info.name = "explicit_euler";
  info.order = 1;
  info.implicit = false;
  info.keeps_angular_momentum = true;
  info.drag_limits_step = true;
  info.error_factor = 3.0;
  info.step_cost = 0.05;
  info.stability = "below the stretch, bend and drag limit";
  info.damping = "none";
  return info;
}

}  // namespace

const std::vector<StepperInfo>& stepper_registry() {
  static const std::vector<StepperInfo> registry{
      implicit_euler(),  implicit_midpoint(),
      energy_momentum(), generalized_alpha(),
      newmark(),         bdf2(),
      tr_bdf2(),         sdirk4(),
      sdirk5(),          verlet(),
      explicit_euler(),
  };
  return registry;
}

const StepperInfo& find_stepper(const std::string& name) {
  for (const StepperInfo& info : stepper_registry()) {
    if (name == info.name) return info;
  }
  throw Error("model_error", "unknown integrator '" + name + "'");
}

const std::vector<std::string>& integrator_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const StepperInfo& info : stepper_registry()) all.emplace_back(info.name);
    return all;
  }();
  return names;
}

}  // namespace der
