#pragma once

#include <optional>

#include "der/model/model.hpp"
#include "der/statics/equilibrium_failure.hpp"
#include "statics/equilibrium/pseudo_transient.hpp"
#include "statics/equilibrium/shape.hpp"
#include "statics/equilibrium/static_loads.hpp"
#include "statics/equilibrium/static_newton.hpp"

namespace der::statics {

/// For loads without a potential, which nothing guides downhill. If the whole of the loads turns no
/// edge far, Newton's method takes it at once. Otherwise finds the equilibrium without loads, which
/// has a potential, and raises all loads from there, with Newton's method at each step from the
/// shape before. Steps in which it fails, or an edge turns too far, are halved. Moves `shape`
/// along; on failure it stays as it is.
std::optional<FailedSearch> raise_loads(const Model& model, const StaticLoads& loads,
                                        StaticNewton& newton, PseudoTransient& continuation,
                                        Shape& shape);

}  // namespace der::statics
