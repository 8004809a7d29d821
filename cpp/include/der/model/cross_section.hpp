#pragma once

#include <optional>

#include "der/energies/damping_times.hpp"
#include "der/scenario/rod.hpp"

namespace der {

/// The properties of a cross-section and its material that enter the mechanics. Director 1 of the
/// section is the direction of its width, director 2 that of its height.
struct SectionProperties {
  double EA = 0.0;               ///< [N]
  double EI = 0.0;               ///< against bending in the x-y plane, of planar scenes [N m^2]
  double EI1 = 0.0;              ///< against curvature toward director 1 [N m^2]
  double EI2 = 0.0;              ///< against curvature toward director 2 [N m^2]
  double GJ = 0.0;               ///< against twist (Saint-Venant) [N m^2]; 0 if not known
  double mass_per_length = 0.0;  ///< [kg/m]
  double spin_inertia = 0.0;     ///< mass moment of inertia about the tangent, per length [kg m]
  DampingTimes damping;
  double draw_radius = 0.0;  ///< half the size in the x-y plane [m]; 0 if not known
  double half_width = 0.0;   ///< [m]; 0 if not known
  double half_height = 0.0;  ///< [m]; 0 if not known
};

/// A section whose height lies in the plane of a planar scene. `material` is empty only with
/// scenario::Stiffness.
SectionProperties section_properties(const scenario::CrossSection& section,
                                     const std::optional<scenario::Material>& material);
/// The section of a rod: in a planar scene its director may turn the width into the plane.
SectionProperties section_properties(const scenario::Rod& rod);

/// Saint-Venant's torsion constant of a solid rectangle with these sides [m^4], to rounding: the
/// series of Timoshenko & Goodier, Theory of Elasticity, sec. 109.
double torsion_constant_of_rectangle(double width, double height);

}  // namespace der
