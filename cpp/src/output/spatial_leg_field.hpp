#pragma once

#include <memory>

#include "output/rod_field.hpp"
#include "output/section_field.hpp"

namespace der {

/// Quantities along a leg in space besides those of its sections.
enum class SpatialLegQuantity {
  Strain,
  Tension,
  TangentX,
  TangentY,
  TangentZ,
  ForceX,  ///< of the force that the rod behind a place exerts on the rod before it [N]
  ForceY,
  ForceZ,
  MomentX,  ///< of the moment likewise [N m]
  MomentY,
  MomentZ
};

// A quantity along a rod in space that has legs, at all nodes, with two values where legs meet: of
// order 2. The moment at a joint is that of the end cell there.
std::unique_ptr<RodField> make_spatial_leg_field(SpatialLegQuantity quantity, const RodMesh& rod,
                                                 const Model& model);
std::unique_ptr<RodField> make_spatial_leg_field(SectionQuantity quantity, const RodMesh& rod,
                                                 const Model& model);

}  // namespace der
