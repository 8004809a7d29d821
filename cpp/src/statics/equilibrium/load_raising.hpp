#pragma once

#include <optional>

#include "der/model/model.hpp"
#include "der/statics/equilibrium_failure.hpp"
#include "statics/equilibrium/shape.hpp"
#include "statics/equilibrium/static_loads.hpp"
#include "statics/equilibrium/static_newton.hpp"

namespace der::statics {

/// For loads without a potential, which nothing guides downhill: raises all loads from none to
/// their whole, with Newton's method at each step from the shape before, and moves `shape` along.
/// Steps in which Newton's method fails, or an edge turns too far to be followed, are halved; the
/// first one is the whole. On failure the shape stays as it is.
std::optional<FailedSearch> raise_loads(const Model& model, const StaticLoads& loads,
                                        StaticNewton& newton, Shape& shape);

}  // namespace der::statics
