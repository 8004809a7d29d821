#pragma once

#include "der/scenario/scenario.hpp"

namespace der::scenario {

/// Writes a valid scene in the terms of its chosen model (model_choice.hpp), so that all that
/// follows sees one form:
///
/// - `planar`: vectors lose z; a rotation about z becomes `Support::rotation`, a moment vector
///   `Moment::moment`, a natural curvature signed numbers.
/// - `spatial_bend`, `spatial`: vectors get z = 0 where they have two components; `rotation`
/// becomes
///   `axis_rotation`, a moment a vector, a natural curvature pairs.
void conform(Scene& scene, ModelChoice model);

}  // namespace der::scenario
