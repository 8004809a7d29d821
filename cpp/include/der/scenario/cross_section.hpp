#pragma once

#include <optional>
#include <variant>

namespace der::scenario {

struct Circle {
  double radius = 0.0;  ///< [m]
};
struct Tube {
  double inner_radius = 0.0;  ///< [m]
  double outer_radius = 0.0;  ///< [m]
};
struct Rectangle {
  double width = 0.0;   ///< [m] out of the plane of a planar scene
  double height = 0.0;  ///< [m] in the plane of bending of a planar scene
};
struct Stiffness {
  double EA = 0.0;               ///< [N]
  double EI = 0.0;               ///< [N m^2]
  std::optional<double> GJ;      ///< [N m^2], needed only where a scene twists
  double mass_per_length = 0.0;  ///< [kg/m]
};
using CrossSection = std::variant<Circle, Tube, Rectangle, Stiffness>;

struct Material {
  double youngs_modulus = 0.0;  ///< [Pa]
  double density = 0.0;         ///< [kg/m^3]
};

}  // namespace der::scenario
