#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

struct Model;

/// Potential energy [J] of the weight in the present gravity, zero at the origin.
double gravity_energy(const Model& model, const Configuration& here);

/// The part of it that belongs to a gravity that follows controls: bilinear in these and in the
/// coordinates. As both change, the weight works along the motion, and the change of gravity by
/// what this is after it less what it was before; the ledger has both among the loads.
double driven_gravity_energy(const Model& model, const Configuration& here);
/// The same of a part of the model, whose lumped masses [kg] these are.
double driven_gravity_energy(const Model& model, const Vector& masses, const Configuration& here);

}  // namespace der
