#pragma once

#include <optional>

#include "der/model/load_variation.hpp"
#include "der/model/model.hpp"

namespace der::scenario {
struct Scene;
}  // namespace der::scenario

namespace der {

/// What varies with the load factor in `model`, which was built from `scene`: one load or
/// prescribed motion, or all. None where the scene's analysis knows no factor.
std::optional<LoadVariation> load_variation(const scenario::Scene& scene, const Model& model);

}  // namespace der
