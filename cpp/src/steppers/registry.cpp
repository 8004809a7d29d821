#include "der/core/error.hpp"
#include "der/steppers/names.hpp"
#include "der/steppers/stepper.hpp"
#include "steppers.hpp"

namespace der {

// Error factors: 3/(2^p - 1), but for two of them. Of bdf2 the first half goes on from a half step,
// as the whole one does, which makes the whole one better than it would be among its like: 1.8, and
// more while steps grow. Of sdirk4 and sdirk5 stiff motion converges at order 2: 0.7 instead of 0.2
// and 0.1.
const std::vector<StepperInfo>& stepper_registry() {
  static const std::vector<StepperInfo> registry = {
      {"implicit_euler", 1, true, false, false, 3.0, "L-stable: any step", "strong, all motion",
       make_runge_kutta<kImplicitEuler>},
      {"implicit_midpoint", 2, true, true, false, 1.0, "A-stable: any step", "none",
       make_runge_kutta<kImplicitMidpoint>},
      {"energy_momentum", 2, true, true, false, 1.0, "A-stable: any step", "none",
       make_energy_momentum},
      {"generalized_alpha", 2, true, false, false, 1.0, "A-stable: any step",
       "fast motion only, as chosen", make_generalized_alpha},
      {"bdf2", 2, true, false, false, 2.5, "L-stable: any step", "fast motion, some of the slow",
       make_bdf2},
      {"tr_bdf2", 2, true, false, false, 1.0, "L-stable: any step", "fast motion",
       make_runge_kutta<kTrBdf2>},
      {"sdirk4", 4, true, false, false, 0.7, "L-stable: any step", "fast motion",
       make_runge_kutta<kSdirk4>},
      {"sdirk5", 5, true, false, false, 0.7, "L-stable: any step", "fast motion",
       make_runge_kutta<kSdirk5>},
      {"verlet", 2, false, true, false, 1.0, "below the stretch and bend limit", "none",
       make_verlet},
      {"explicit_euler", 1, false, true, true, 3.0, "below the stretch, bend and drag limit",
       "none", make_explicit_euler},
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
