#pragma once

#include <optional>
#include <variant>

#include "der/energies/damping_times.hpp"

namespace der::scenario {

struct Circle {
  double radius = 0.0;  ///< [m]
};
struct Tube {
  double inner_radius = 0.0;  ///< [m]
  double outer_radius = 0.0;  ///< [m]
};

// The width lies along director 1 of the section, the height along director 2 (`Rod::director`).

struct Rectangle {
  double width = 0.0;   ///< [m]
  double height = 0.0;  ///< [m]
};
struct Ellipse {
  double width = 0.0;   ///< [m], the full axis
  double height = 0.0;  ///< [m], the full axis
};
/// Either `EI`, the same for bending toward any side, or both `EI1` and `EI2`.
struct Stiffness {
  double EA = 0.0;               ///< [N]
  std::optional<double> EI;      ///< [N m^2]
  std::optional<double> EI1;     ///< [N m^2] against curvature toward director 1
  std::optional<double> EI2;     ///< [N m^2] against curvature toward director 2
  std::optional<double> GJ;      ///< [N m^2], needed only where a scene twists
  double mass_per_length = 0.0;  ///< [kg/m]
  /// Mass moment of inertia of the section about the tangent, per length [kg m], for its spin.
  std::optional<double> rotary_inertia;
  DampingTimes damping;
};
using CrossSection = std::variant<Circle, Tube, Rectangle, Ellipse, Stiffness>;

/// At most one of Poisson's ratio and the shear modulus is given; only a scene that twists needs
/// one.
struct Material {
  double youngs_modulus = 0.0;           ///< [Pa]
  double density = 0.0;                  ///< [kg/m^3]
  std::optional<double> poissons_ratio;  ///< of an isotropic material: G = E / (2 (1 + nu))
  std::optional<double> shear_modulus;   ///< [Pa]
  DampingTimes damping;
};

}  // namespace der::scenario
