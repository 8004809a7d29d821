#pragma once

#include <memory>

#include "output/rod_field.hpp"

namespace der {

// Bending, twist and strain of a rod in space: at its joints or the middles of its edges, linear in
// between and beyond.

/// Quantities of the section at a joint.
enum class SectionQuantity {
  Curvature,   ///< magnitude [1/m]
  Curvature1,  ///< towards the first director [1/m]
  Curvature2,  ///< towards the second director [1/m]
  Moment,      ///< magnitude of the bending moment [N m]
  Moment1,     ///< EI1 times the curvature in excess of the natural one [N m]
  Moment2,     ///< EI2 likewise [N m]
  Twist,       ///< rotation of the section per length [rad/m]
  Torque,      ///< [N m]
};

/// All but the magnitudes need a model with sections.
std::unique_ptr<RodField> make_section_field(SectionQuantity quantity, const RodLayout& rod,
                                             const Model& model);

/// The strain in the edges, times a stiffness [N] (1: the strain itself).
std::unique_ptr<RodField> make_edge_strain_field(double stiffness, const RodLayout& rod,
                                                 const Model& model);

}  // namespace der
