#pragma once

#include <memory>

#include "der/model/model.hpp"
#include "output/rod_field.hpp"

namespace der {

/// Angle [rad] of the tangent of a planar rod from the x axis, continuous along the rod. Whole
/// turns count: from a clamp, or from the edge that the state follows (model/followed.hpp).
std::unique_ptr<RodField> make_slope_field(const RodMesh& rod, const Model& model);

/// Component `number` of the unit tangent, in the direction of growing arc length.
std::unique_ptr<RodField> make_tangent_field(int number, const RodMesh& rod, const Model& model);

}  // namespace der
