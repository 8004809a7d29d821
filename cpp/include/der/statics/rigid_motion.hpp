#pragma once

#include <string>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// Looks for a part of the structure that can move as a whole in x or y and on which `force` [N]
/// does not balance in that direction: it has no equilibrium. Says which and how, empty if there is
/// none.
std::string find_unheld_part(const Model& model, const Vector& force);

}  // namespace der
