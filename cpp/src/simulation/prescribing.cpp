// Supports that a program moves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "der/core/error.hpp"
#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"

namespace der {
namespace {

/// The first control that moves this component; Error if the scene prescribes none.
const PrescribedControl& check_prescribed(const Model& model, std::size_t support,
                                          const std::string& component) {
  std::string known;
  for (const PrescribedControl& candidate : model.prescribed) {
    if (candidate.support == support && candidate.component == component) return candidate;
    const std::string name =
        fmt::format("{} of support {}", candidate.component, candidate.support);
    if (known.find(name) == std::string::npos) known += (known.empty() ? "" : ", ") + name;
  }
  throw Error(
      "model_error",
      fmt::format("the scene does not prescribe {} of support {} (counted from 0): give that "
                  "support 'prescribe: {{{}: 0}}'; it prescribes {}",
                  component, support, component, known.empty() ? "nothing" : known));
}

}  // namespace

void Simulation::prescribe(std::size_t support, const std::string& component, double value) {
  check_prescribed(model_, support, component);
  if (adaptive_) {
    throw Error("model_error",
                "supports are moved from step to step, which takes steps of one length: give the "
                "scene a time.step in place of its tolerance");
  }
  if (!std::isfinite(value)) {
    throw Error("model_error",
                fmt::format("support {}: {} must be finite, got {}", support, component, value));
  }
  const bool steps = scenario_.scene().is_dynamic();
  for (const PrescribedControl& moved : model_.prescribed) {
    if (moved.support != support || moved.component != component) continue;
    const double now = control_value(model_, state_, moved.control);
    const Ramp ramp{moved.control, state_.time, steps ? next_time() : state_.time, now, value};
    const auto known =
        std::find_if(state_.ramps.begin(), state_.ramps.end(),
                     [&](const Ramp& earlier) { return earlier.control == moved.control; });
    if (known == state_.ramps.end()) {
      state_.ramps.push_back(ramp);
    } else {
      *known = ramp;
    }
  }
}

double Simulation::prescribed(std::size_t support, const std::string& component) const {
  const PrescribedControl& found = check_prescribed(model_, support, component);
  return control_value(model_, state_, found.control);
}

}  // namespace der
