#pragma once

#include <cstddef>
#include <vector>

#include "der/core/types.hpp"
#include "der/energies/damping_times.hpp"
#include "der/energies/viscous_term.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

// Internal damping (Kelvin-Voigt): the strains s of an element bear the loads K (s - s0) + V s'.
// The forces B' V B v on the nodes, B = ds/dx, have no part in rigid motions, and take energy from
// all others (docs/damping.md).

/// The number of elements in each list of a model.
using ElementCounts = std::vector<std::size_t>;
ElementCounts count_elements(const Model& model);

/// Damps the elements that were added since `before`, but for corners (building/corner.hpp).
void damp_elements(const DampingTimes& times, const ElementCounts& before, Model& model);

/// Adds the viscous forces [N] on all degrees of freedom, with the sign of a gradient.
void add_viscous_forces(const Model& model, const Moving& moving, Vector& gradient);

/// The power [W] of what turns clamps against the viscous loads beside them.
double driven_viscous_power(const Model& model, const Moving& moving);

/// Sets `rates`, one for each control, to those of the controls that turn clamps at `time` [s], in
/// a motion that goes on from `from` to `to`; leaves it empty where no clamp of a rod with internal
/// damping turns.
void set_turn_rates(const Model& model, const State& state, double from, double to, double time,
                    Vector& rates);
/// The same at a state, in the motion of its last step.
void set_turn_rates(const Model& model, const State& state, Vector& rates);
/// The rate of one control there.
double turn_rate(const Model& model, const State& state, Index control);

}  // namespace der
