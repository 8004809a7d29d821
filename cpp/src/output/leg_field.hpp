#pragma once

#include <memory>

#include "output/rod_field.hpp"

namespace der {

enum class LegQuantity {
  Moment,
  Curvature,
  NaturalCurvature,
  Strain,
  Tension,
  ForceX,  ///< of the force that the rod behind a place exerts on the rod before it [N]
  ForceY,
  Slope,
  TangentX,
  TangentY
};

/// A quantity along a rod that has legs, at all nodes, with two values where legs meet: of order 4
/// on legs that know their arcs, else of order 2. The moment at a joint is an entry of the end cell
/// there. The tension is the component along the tangent of the force in the rod, which is known
/// along each edge. The slope counts whole turns where a leg has a joint with a rotation.
std::unique_ptr<RodField> make_leg_field(LegQuantity quantity, const RodMesh& rod,
                                         const Model& model);

/// The coordinate x or y [m] of the curve, at all nodes of a rod that has legs. A node inside a leg
/// of order 4 lies beside the curve by l^2/12 of the curvature.
std::unique_ptr<RodField> make_leg_place_field(int component, const RodMesh& rod,
                                               const Model& model);

}  // namespace der
