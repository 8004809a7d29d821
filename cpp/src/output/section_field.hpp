#pragma once

#include <memory>

#include "output/rod_field.hpp"

namespace der {

// Bending and twist of a rod in space: at all nodes and wherever loads between them make a kink,
// linear in between, of order 2 up to the ends (output/moment_recovery.hpp).

/// Quantities of a section.
enum class SectionQuantity {
  Curvature,          ///< magnitude [1/m]
  Curvature1,         ///< towards the first director [1/m]
  Curvature2,         ///< towards the second director [1/m]
  Moment,             ///< magnitude of the bending moment [N m]
  Moment1,            ///< EI1 times the curvature in excess of the natural one [N m]
  Moment2,            ///< EI2 likewise [N m]
  Twist,              ///< rotation of the section per length [rad/m]
  Torque,             ///< [N m]
  NaturalCurvature1,  ///< without stress, towards the first director [1/m]
  NaturalCurvature2,  ///< towards the second director [1/m]
  NaturalTwist,       ///< [rad/m]
};

/// Whether it is the part of a curvature or moment towards a director.
bool is_towards_director(SectionQuantity quantity);

/// All but the magnitudes need a model with sections, or, if they are towards a director, a clamp
/// that holds the section of a rod without twist: throws Error where none does.
std::unique_ptr<RodField> make_section_field(SectionQuantity quantity, const RodMesh& rod,
                                             const Model& model);

}  // namespace der
