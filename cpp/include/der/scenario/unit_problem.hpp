#pragma once

#include <string>

#include "der/scenario/scenario.hpp"

namespace der::scenario {

/// The first number of a checked scene that no structure has but many have in another unit, and
/// that unit, in a sentence; empty: there is none.
std::string unit_problem(const Scene& scene);

}  // namespace der::scenario
