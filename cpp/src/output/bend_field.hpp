#pragma once

#include <memory>

#include "output/rod_field.hpp"

namespace der {

/// Turning angles [rad] at the nodes that bend: inner nodes, and ends that are clamped.
std::unique_ptr<RodField> make_turning_angle_field(const RodMesh& rod, const Model& model);

// Curvature, natural curvature and moment: at all nodes and wherever loads between them make a kink
// or a jump, linear in between, of order 2 up to the ends (output/moment_recovery.hpp). A rod
// without bending stiffness has them at its inner nodes alone.

/// In [1/m].
std::unique_ptr<RodField> make_curvature_field(const RodMesh& rod, const Model& model);
/// Curvature [1/m] of the rod without stress, as actuations have it at the state; in a plane.
std::unique_ptr<RodField> make_natural_curvature_field(const RodMesh& rod, const Model& model);
/// In [N m].
std::unique_ptr<RodField> make_moment_field(const RodMesh& rod, const Model& model);

}  // namespace der
