#pragma once

#include "der/model/model.hpp"
#include "statics/equilibrium/pseudo_transient.hpp"
#include "statics/equilibrium/shape.hpp"
#include "statics/equilibrium/static_loads.hpp"

namespace der::statics {

/// Raises the loads from a small fraction in doubling steps, with a pseudo-transient continuation
/// at each one from the shape before: a slender structure buckles before the whole load would crush
/// it. `force_scale` [N] is the largest acting force under the whole load. Returns whether `shape`
/// is now an equilibrium under the whole load; if not it stays as it was.
bool step_loads(const Model& model, const StaticLoads& loads, double force_scale,
                PseudoTransient& continuation, Shape& shape);

}  // namespace der::statics
