#include "der/model/cross_section.hpp"

#include <cmath>

#include "der/core/constants.hpp"

namespace der {
namespace {

struct Geometry {
  double area = 0.0;           // [m^2]
  double second_moment = 0.0;  // of area, about the axis out of the plane [m^4]
  double half_height = 0.0;    // [m]
};

Geometry geometry(const scenario::Circle& s) {
  const double r2 = s.radius * s.radius;
  return {kPi * r2, 0.25 * kPi * r2 * r2, s.radius};
}

Geometry geometry(const scenario::Tube& s) {
  const double i2 = s.inner_radius * s.inner_radius;
  const double o2 = s.outer_radius * s.outer_radius;
  return {kPi * (o2 - i2), 0.25 * kPi * (o2 * o2 - i2 * i2), s.outer_radius};
}

Geometry geometry(const scenario::Rectangle& s) {
  return {s.width * s.height, s.width * std::pow(s.height, 3) / 12.0, 0.5 * s.height};
}

}  // namespace

SectionProperties section_properties(const scenario::CrossSection& section,
                                     const std::optional<scenario::Material>& material) {
  return std::visit(
      [&](const auto& s) -> SectionProperties {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, scenario::Stiffness>) {
          return {s.EA, s.EI, s.mass_per_length, 0.0};
        } else {
          const Geometry g = geometry(s);
          const double E = material.value().youngs_modulus;
          return {E * g.area, E * g.second_moment, material.value().density * g.area,
                  g.half_height};
        }
      },
      section);
}

}  // namespace der
