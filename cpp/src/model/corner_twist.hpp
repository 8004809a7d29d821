#pragma once

#include "der/model/model.hpp"

namespace der {

/// The drawn tangent that the leg which arrives at a corner, or leaves it, has there: that of its
/// edge, which has the direction of the tangent at its middle, turned on as the leg turns at the
/// edge's other end.
Vec3 leg_tangent(const RodMesh& rod, Index corner, bool arrives, const Model& model);

/// Angle [rad] by which the section after a corner is turned against the one before, transported
/// from edge to edge, where the rod is drawn without twist; zero at other places. The edges of a
/// curved leg lean against its tangent at the corner. Sections go along the legs to these tangents,
/// and from one to the other by the smallest rotation; the edges' own smallest rotation is another.
double corner_twist(const RodMesh& rod, Index place, const Model& model);

}  // namespace der
