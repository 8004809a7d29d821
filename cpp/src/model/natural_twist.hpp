#pragma once

#include "der/model/model.hpp"

namespace der {

/// Natural twist at the middle of the length over which a vertex twists, its mean there [rad/m]: as
/// the scene gives it, or that of the drawn rod.
double natural_twist_at(const RodMesh& rod, const RodVertex& vertex);

}  // namespace der
