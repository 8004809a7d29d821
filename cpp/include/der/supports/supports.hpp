#pragma once

#include <cstddef>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

namespace scenario {
struct Support;
}

/// Holds or moves the components that a support names, adds its spring, and enters its clamps into
/// the rod's layout. Must run after the rods are laid out and before their elements are made.
/// `number` is its place in the scene.
void add_support(const scenario::Support& support, std::size_t number, Model& model);

}  // namespace der
