#pragma once

#include "der/model/model.hpp"

namespace der {

// At a corner (model/corner.hpp) a clamp holds the tangent and the section of each of the two legs.
// The layout has them for the edge that leaves it.

/// A clamp as the edge that arrives there, or leaves, sees it. The two differ at a corner only.
Clamp clamp_of_leg(const Clamp& clamp, bool arrives, const RodMesh& rod, const Model& model);

/// The drawn section at one end of an edge, where the drawn tangent is `tangent`.
SectionFrame reference_section_at_end(const RodMesh& rod, Index edge, bool last,
                                      const Vec3& tangent);

}  // namespace der
