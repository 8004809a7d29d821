#pragma once

#include <string>
#include <vector>

#include "der/simulation.hpp"

namespace der {

/// Why a run that follows a tolerance took very many steps, and what takes fewer, in sentences;
/// mostly none. Unlike a warning, a hint casts no doubt on the result.
std::vector<std::string> hints(const Simulation& simulation);

}  // namespace der
