#pragma once

#include <string>

#include "der/scenario/scenario.hpp"

namespace der::scenario {

/// Why the answers of a planar scene cannot be tested against motion out of the plane, as a clause;
/// empty if they can. The test is one of a potential in space (statics/out_of_plane.hpp).
std::string why_not_tested_out_of_plane(const Scene& scene);

}  // namespace der::scenario
