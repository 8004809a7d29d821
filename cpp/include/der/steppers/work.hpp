#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

// The parts of a step's energy ledger that do not depend on the stepper. A stage of a stepper
// balances M a + C v + grad E - f = r, with r the reactions on held degrees of freedom and what the
// solver leaves on free ones; along the step's displacement d that is an identity between works
// (docs/energy.md).

/// Sets `displacement` [m] to what a stage that counts with the weight `share` contributes to a
/// step of `dt`: that share of `velocities` times `dt`. Held degrees of freedom move evenly from
/// `start` to `end`.
void stage_displacement(const Model& model, const Vector& start, const Vector& end, double share,
                        double dt, const Eigen::Ref<const Vector>& velocities,
                        Vector& displacement);

/// Work [J] of moments and circulatory loads along `displacement` [m].
double moment_work(const Model& model, const Configuration& here, const Vector& displacement);

/// Works [J] that controls do without a displacement.
struct ControlWork {
  double supports = 0.0;   ///< by clamps that turn
  double actuation = 0.0;  ///< by changes of the rest shape
  /// By moments, where actuations turn their place against its edges, or clamps turn it.
  double loads = 0.0;
};
/// The works of controls that change from those of `before` to those of `after`, which are alike in
/// all else: the energy that this gives the elements. What moments do on actuated turns comes out
/// of it.
ControlWork control_work(const Model& model, const Configuration& before,
                         const Configuration& after);

}  // namespace der
