#pragma once

#include <string>
#include <utility>
#include <vector>

#include "der/scenario/document.hpp"
#include "der/scenario/reader.hpp"

namespace der {

/// An `Override` whose value is no text, so that nothing has to be parsed.
using ValueOverride = std::pair<std::string, scenario::Value>;

/// The scene with these values in place of its own, as `Scenario::with`.
Scenario with_values(const Scenario& scenario, const std::vector<ValueOverride>& values);

}  // namespace der
