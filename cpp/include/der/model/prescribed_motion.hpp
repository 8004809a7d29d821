#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Moves the held degrees of freedom of `positions` [m] to where the supports have them: at their
/// initial values, displaced by what `controls` say.
void apply_prescribed_motion(const Model& model, const Vector& controls, Vector& positions);

/// Rate at `time` [s] in a step of a control that changes by `mean` over the step: that of a sine
/// or a smooth table. Straight pieces, and what a program sets, have the mean.
double control_rate(const Model& model, const State& state, Index control, double time,
                    double mean);

/// Velocity [m/s] at `time` [s] in a step of a degree of freedom that a support holds and that
/// moves by `mean` [m/s] over the step (control_rate).
double held_velocity(const Model& model, const State& state, const HeldDof& held, double time,
                     double mean);

/// Sets `velocities` to those of `state`, from which a step of `dt` [s] starts, but for held
/// degrees of freedom: these have theirs at `time` [s] of the step, at whose end they are at `end`.
/// A kink of a table, or a program, sets it apart from that of the step before.
void velocities_in_step(const Model& model, const State& state, const Vector& end, double dt,
                        double time, Vector& velocities);

}  // namespace der
