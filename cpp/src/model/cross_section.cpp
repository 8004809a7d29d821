#include "der/model/cross_section.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/constants.hpp"

namespace der {
namespace {

struct Geometry {
  double area = 0.0;         // [m^2]
  double moment1 = 0.0;      // second moment of area for bending toward director 1 [m^4]
  double moment2 = 0.0;      // ... toward director 2 [m^4]
  double torsion = 0.0;      // Saint-Venant's constant [m^4]
  double half_width = 0.0;   // [m]
  double half_height = 0.0;  // [m]
};

Geometry round_geometry(double area, double moment, double radius) {
  return {area, moment, moment, 2.0 * moment, radius, radius};
}

Geometry geometry(const scenario::Circle& s) {
  const double r2 = s.radius * s.radius;
  return round_geometry(kPi * r2, 0.25 * kPi * r2 * r2, s.radius);
}

Geometry geometry(const scenario::Tube& s) {
  const double i2 = s.inner_radius * s.inner_radius;
  const double o2 = s.outer_radius * s.outer_radius;
  return round_geometry(kPi * (o2 - i2), 0.25 * kPi * (o2 * o2 - i2 * i2), s.outer_radius);
}

Geometry geometry(const scenario::Rectangle& s) {
  return {s.width * s.height,
          s.height * std::pow(s.width, 3) / 12.0,
          s.width * std::pow(s.height, 3) / 12.0,
          torsion_constant_of_rectangle(s.width, s.height),
          0.5 * s.width,
          0.5 * s.height};
}

Geometry geometry(const scenario::Ellipse& s) {
  const double a = 0.5 * s.width;
  const double b = 0.5 * s.height;
  return {kPi * a * b,
          0.25 * kPi * b * std::pow(a, 3),
          0.25 * kPi * a * std::pow(b, 3),
          kPi * std::pow(a * b, 3) / (a * a + b * b),
          a,
          b};
}

/// 0 if not known.
double shear_modulus(const scenario::Material& material) {
  if (material.shear_modulus) return *material.shear_modulus;
  if (!material.poissons_ratio) return 0.0;
  return material.youngs_modulus / (2.0 * (1.0 + *material.poissons_ratio));
}

SectionProperties properties(const scenario::Stiffness& given) {
  SectionProperties section;
  section.EA = given.EA;
  section.EI1 = given.EI ? *given.EI : *given.EI1;
  section.EI2 = given.EI ? *given.EI : *given.EI2;
  section.GJ = given.GJ.value_or(0.0);
  section.mass_per_length = given.mass_per_length;
  // That of a homogeneous section: rho (I1 + I2).
  const double homogeneous = given.mass_per_length * (section.EI1 + section.EI2) / given.EA;
  section.spin_inertia = given.rotary_inertia.value_or(homogeneous);
  section.damping = given.damping;
  return section;
}

SectionProperties properties(const Geometry& shape, const scenario::Material& material) {
  SectionProperties section;
  section.EA = material.youngs_modulus * shape.area;
  section.EI1 = material.youngs_modulus * shape.moment1;
  section.EI2 = material.youngs_modulus * shape.moment2;
  section.GJ = shear_modulus(material) * shape.torsion;
  section.mass_per_length = material.density * shape.area;
  section.spin_inertia = material.density * (shape.moment1 + shape.moment2);
  section.damping = material.damping;
  section.half_width = shape.half_width;
  section.half_height = shape.half_height;
  return section;
}

}  // namespace

SectionProperties section_properties(const scenario::CrossSection& section,
                                     const std::optional<scenario::Material>& material) {
  SectionProperties result = std::visit(
      [&](const auto& shape) {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, scenario::Stiffness>) {
          return properties(shape);
        } else {
          return properties(geometry(shape), material.value());
        }
      },
      section);
  result.EI = result.EI2;
  result.draw_radius = result.half_height;
  return result;
}

SectionProperties section_properties(const scenario::Rod& rod) {
  SectionProperties result = section_properties(rod.cross_section, rod.material);
  // In a planar scene one of the two directors of an anisotropic section is z.
  const bool width_in_plane = rod.director && (*rod.director)[2] == 0.0;
  if (width_in_plane) {
    result.EI = result.EI1;
    result.draw_radius = result.half_width;
  }
  return result;
}

double torsion_constant_of_rectangle(double width, double height) {
  const double ratio = std::max(width, height) / std::min(width, height);
  // The series has tanh(x) = 1 - 2 / (exp(2 x) + 1): the sum of 1 / n^5 over odd n is known, and
  // the rest converges as exp(-pi n ratio).
  constexpr double zeta5 = 1.0369277551433699263;
  double sum = 31.0 / 32.0 * zeta5;
  for (int n = 1; n <= 13; n += 2) {
    sum -= 2.0 / (std::pow(n, 5) * (std::exp(n * kPi * ratio) + 1.0));
  }
  const double k = (1.0 - 192.0 / (std::pow(kPi, 5) * ratio) * sum) / 3.0;
  return k * ratio * std::pow(std::min(width, height), 4);
}

}  // namespace der
