#include "der/core/error.hpp"
#include "der/steppers/names.hpp"
#include "der/steppers/stepper.hpp"
#include "steppers.hpp"

namespace der {

const std::vector<StepperInfo>& stepper_registry() {
  static const std::vector<StepperInfo> registry = {
      {"implicit_euler", 1, true, "L-stable at any step; damps motion away", make_implicit_euler},
      {"explicit_euler", 1, false, "cheap steps, stable only below a small step",
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

}  // namespace der
