#pragma once

#include <string>

#include "der/model/model.hpp"

namespace der::statics {

/// Looks for a rod in space that can turn as a whole about the tangent that its clamps hold: they
/// leave the section free, no spring or foundation holds it against that, and the nodes that
/// supports hold lie on the line of this tangent. Equilibria are then neutral, and loads without a
/// potential may have none. Says which and what to write, empty if there is none.
std::string find_free_spin(const Model& model);

}  // namespace der::statics
