#pragma once

#include <string>
#include <vector>

#include "der/simulation.hpp"

namespace der {

/// Why a run that follows a tolerance took very many steps, and what takes fewer, in sentences;
/// mostly none. Unlike a warning, a hint casts no doubt on the result. `counters` are of the whole
/// run; whether steps have become shorter is known of the part since it was resumed.
std::vector<std::string> hints(const Simulation& simulation, const Counters& counters);

}  // namespace der
