#include "der/core/error.hpp"
#include "der/steppers/names.hpp"
#include "der/steppers/stepper.hpp"
#include "steppers.hpp"

namespace der {

const std::vector<StepperInfo>& stepper_registry() {
  static const std::vector<StepperInfo> registry = {
      {"implicit_euler", 1, true, false, false, "L-stable: any step", "strong, all motion",
       make_implicit_euler},
      {"implicit_midpoint", 2, true, true, false, "A-stable: any step", "none",
       make_implicit_midpoint},
      {"generalized_alpha", 2, true, false, false, "A-stable: any step",
       "fast motion only, as chosen", make_generalized_alpha},
      {"bdf2", 2, true, false, false, "L-stable: any step", "fast motion, some of the slow",
       make_bdf2},
      {"tr_bdf2", 2, true, false, false, "L-stable: any step", "fast motion", make_tr_bdf2},
      {"sdirk4", 4, true, false, false, "L-stable: any step", "fast motion", make_sdirk4},
      {"verlet", 2, false, true, false, "below the stretch and bend limit", "none", make_verlet},
      {"explicit_euler", 1, false, true, true, "below the stretch, bend and drag limit", "none",
       make_explicit_euler},
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

bool is_implicit(const std::string& integrator) { return find_stepper(integrator).implicit; }

}  // namespace der
