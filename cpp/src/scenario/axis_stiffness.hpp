#pragma once

#include <string>

#include "scenario/format.hpp"

namespace der::scenario {

/// Stiffnesses along x and y, not both 0: one number for both axes, or one for each.
Format<Components> axis_stiffness(const std::string& unit);

}  // namespace der::scenario
