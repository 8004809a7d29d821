#pragma once

#include <string>

#include "scenario/format.hpp"

namespace der::scenario {

/// Stiffnesses along the axes, not all 0: one number for all axes, or one for each.
Format<Components> axis_stiffness(const std::string& unit);

}  // namespace der::scenario
