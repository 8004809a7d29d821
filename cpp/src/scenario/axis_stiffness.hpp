#pragma once

#include <string>

#include "scenario/format.hpp"

namespace der::scenario {

/// Stiffnesses along the axes, not all 0: one number for all axes, or one for each.
Format<Components> axis_stiffness(const std::string& unit);

/// Stiffnesses of a section against turning, not all 0: one number, or three.
Format<Components> section_stiffness(const std::string& unit);

}  // namespace der::scenario
