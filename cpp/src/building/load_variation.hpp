#pragma once

#include <optional>

#include "der/model/load_variation.hpp"
#include "der/model/model.hpp"

namespace der::scenario {
struct Scene;
}  // namespace der::scenario

namespace der {

/// The dependence on the load factor of `model`, which was built from `scene`: of one load or
/// prescribed motion, or of all. None if the analysis of the scene has no load factor.
std::optional<LoadVariation> load_variation(const scenario::Scene& scene, const Model& model);

}  // namespace der
