#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace der {

/// Facts about a time integrator, for the scene's keys, the docs and the tests that loop over all.
struct StepperInfo {
  std::string_view name;  ///< as a scene gives it in `time.integrator`
  int order = 2;
  bool implicit = true;
  bool keeps_angular_momentum = false;
  bool drag_limits_step = false;  ///< whether drag bounds the stable step of an explicit one
  /// Factor from the difference between an adaptive step done as a whole and in two halves to the
  /// error of the halves.
  double error_factor = 1.0;
  double step_cost = 1.0;      ///< of a step, against one of an implicit stepper of one stage
  std::string_view stability;  ///< in words
  std::string_view damping;    ///< numerical damping, in words
};

/// Every time integrator.
const std::vector<StepperInfo>& stepper_registry();
/// Throws Error for an unknown name.
const StepperInfo& find_stepper(const std::string& name);
/// The names that a scene can give as `time.integrator`.
const std::vector<std::string>& integrator_names();

}  // namespace der
