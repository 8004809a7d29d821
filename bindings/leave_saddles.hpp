#pragma once

#include <optional>
#include <variant>

#include "arguments.hpp"
#include "der/scenario/scenario.hpp"

namespace der::python {

/// Whether an unstable equilibrium is left for a stable one: as `given`, else as the scene says.
/// Throws TypeError if it is not a truth value.
inline bool leaves_saddles(const std::optional<Truth>& given, const Scenario& scenario) {
  if (given) return given->value("leave_saddles");
  const auto* analysis = std::get_if<scenario::StaticAnalysis>(&scenario.scene().analysis);
  return analysis == nullptr || analysis->leave_saddles;
}

}  // namespace der::python
