#pragma once

#include <optional>

#include "der/scenario/cross_section.hpp"

namespace der {

/// The properties of a cross-section and its material that enter the mechanics.
struct SectionProperties {
  double EA = 0.0;               ///< [N]
  double EI = 0.0;               ///< bending in the plane [N m^2]
  double mass_per_length = 0.0;  ///< [kg/m]
  double draw_radius = 0.0;      ///< half the height in the plane [m]; 0 if not known
};

/// `material` is empty only with scenario::Stiffness.
SectionProperties section_properties(const scenario::CrossSection& section,
                                     const std::optional<scenario::Material>& material);

}  // namespace der
