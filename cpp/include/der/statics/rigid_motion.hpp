#pragma once

#include <string>

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// Looks for a part of the structure that can move as a whole in x or y and on which `force` [N]
/// does not balance in that direction: it has no equilibrium. Says which and how, empty if there is
/// none.
std::string find_unheld_part(const Model& model, const Vector& force);

/// Looks for a part of the structure that springs or foundations alone hold against a rigid motion,
/// with a stiffness above 0 that is less than `rounding` [N/m], the error of the eigenvalues of the
/// stiffness matrix here: no shape can be told from one that is moved by it. Says which and how,
/// empty if there is none.
std::string find_weakly_held_part(const Model& model, const Configuration& here, double rounding);

}  // namespace der
