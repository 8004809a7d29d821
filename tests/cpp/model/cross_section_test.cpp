#include "der/model/cross_section.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "der/core/constants.hpp"
#include "der/scenario/rod.hpp"

namespace der {
namespace {

using doctest::Approx;

constexpr double kE = 200.0;  // [Pa]
constexpr double kG = 80.0;   // [Pa], Poisson's ratio 0.25
constexpr double kDensity = 3.0;

SectionProperties of(const scenario::CrossSection& section) {
  scenario::Material material;
  material.youngs_modulus = kE;
  material.poissons_ratio = 0.25;
  material.density = kDensity;
  return section_properties(section, material);
}

TEST_CASE("cross-section: torsion constants of rectangles, from tables and by the plain series") {
  // Timoshenko & Goodier, Theory of Elasticity, sec. 109: J = k a b^3 with a >= b.
  const auto k = [](double ratio) { return torsion_constant_of_rectangle(ratio, 1.0) / ratio; };
  CHECK(k(1.0) == Approx(0.1406).epsilon(5e-4));
  CHECK(k(1.5) == Approx(0.196).epsilon(3e-3));
  CHECK(k(2.0) == Approx(0.229).epsilon(3e-3));
  CHECK(k(5.0) == Approx(0.291).epsilon(3e-3));
  CHECK(k(10.0) == Approx(0.312).epsilon(3e-3));
  CHECK(k(1e9) == Approx(1.0 / 3.0).epsilon(1e-8));
  for (const double ratio : {1.0, 1.3, 4.0}) {
    double sum = 0.0;
    for (int n = 1999; n >= 1; n -= 2) {  // the rest is below 1e-14
      sum += std::tanh(0.5 * n * kPi * ratio) / std::pow(n, 5);
    }
    const double series = (1.0 - 192.0 / (std::pow(kPi, 5) * ratio) * sum) / 3.0;
    CHECK(k(ratio) == Approx(series).epsilon(1e-13));
    CHECK(torsion_constant_of_rectangle(1.0, ratio) ==
          Approx(torsion_constant_of_rectangle(ratio, 1.0)).epsilon(1e-15));
  }
  CHECK(torsion_constant_of_rectangle(0.02, 0.04) ==
        Approx(1e-8 * torsion_constant_of_rectangle(2.0, 4.0)).epsilon(1e-14));
}

TEST_CASE("cross-section: round sections twist with their polar moment") {
  const SectionProperties solid = of(scenario::Circle{0.5});
  const double moment = kPi / 64.0;  // pi d^4 / 64
  CHECK(solid.EA == Approx(kE * kPi / 4.0));
  CHECK(solid.EI == Approx(kE * moment));
  CHECK(solid.EI1 == solid.EI2);
  CHECK(solid.GJ == Approx(kG * 2.0 * moment));
  CHECK(solid.spin_inertia == Approx(kDensity * 2.0 * moment));
  CHECK(solid.draw_radius == 0.5);
  CHECK(solid.half_width == 0.5);
  const SectionProperties tube = of(scenario::Tube{0.25, 0.5});
  CHECK(tube.GJ == Approx(kG * 2.0 * moment * (1.0 - 1.0 / 16.0)));
  CHECK(tube.EI1 == Approx(kE * moment * (1.0 - 1.0 / 16.0)));
}

TEST_CASE("cross-section: width and height of rectangles and ellipses") {
  const SectionProperties rectangle = of(scenario::Rectangle{0.3, 0.1});
  CHECK(rectangle.EI1 == Approx(kE * 0.1 * 0.027 / 12.0));
  CHECK(rectangle.EI2 == Approx(kE * 0.3 * 0.001 / 12.0));
  CHECK(rectangle.EI == rectangle.EI2);
  CHECK(rectangle.spin_inertia == Approx(kDensity * 0.03 * (0.09 + 0.01) / 12.0));
  CHECK(rectangle.half_width == Approx(0.15));
  CHECK(rectangle.half_height == Approx(0.05));
  CHECK(rectangle.draw_radius == Approx(0.05));
  const SectionProperties ellipse = of(scenario::Ellipse{0.4, 0.2});
  CHECK(ellipse.EA == Approx(kE * kPi * 0.02));
  CHECK(ellipse.EI1 == Approx(kE * kPi / 4.0 * 0.1 * 0.008));
  CHECK(ellipse.EI2 == Approx(kE * kPi / 4.0 * 0.2 * 0.001));
  CHECK(ellipse.GJ == Approx(kG * kPi * 0.008 * 0.001 / (0.04 + 0.01)));
  const SectionProperties round = of(scenario::Ellipse{1.0, 1.0});
  CHECK(round.GJ == Approx(of(scenario::Circle{0.5}).GJ).epsilon(1e-14));
  CHECK(round.EI1 == Approx(of(scenario::Circle{0.5}).EI1).epsilon(1e-14));
}

TEST_CASE("cross-section: stiffnesses given directly") {
  scenario::Stiffness given;
  given.EA = 7.0;
  given.EI = 5.0;
  given.mass_per_length = 2.0;
  const SectionProperties equal = section_properties(given, std::nullopt);
  CHECK(equal.EI1 == 5.0);
  CHECK(equal.EI2 == 5.0);
  CHECK(equal.GJ == 0.0);
  CHECK(equal.spin_inertia == doctest::Approx(2.0 * (5.0 + 5.0) / 7.0));  // homogeneous
  CHECK(equal.half_width == 0.0);
  given.EI.reset();
  given.EI1 = 3.0;
  given.EI2 = 4.0;
  given.GJ = 6.0;
  given.rotary_inertia = 0.5;
  const SectionProperties different = section_properties(given, std::nullopt);
  CHECK(different.EI == 4.0);
  CHECK(different.EI1 == 3.0);
  CHECK(different.GJ == 6.0);
  CHECK(different.spin_inertia == 0.5);
}

TEST_CASE("cross-section: a planar rod bends about z, whichever director lies in its plane") {
  scenario::Rod rod;
  rod.cross_section = scenario::Rectangle{0.3, 0.1};
  rod.material = scenario::Material{kE, kDensity, std::nullopt, std::nullopt, {}};
  CHECK(section_properties(rod).GJ == 0.0);
  for (const scenario::Components& out_of_plane : {scenario::Components{0, 0, 1}, {1, 0, -2}}) {
    rod.director = out_of_plane;
    CHECK(section_properties(rod).EI == section_properties(rod).EI2);
    CHECK(section_properties(rod).draw_radius == Approx(0.05));
  }
  rod.director = {1.0, -1.0, 0.0};
  CHECK(section_properties(rod).EI == section_properties(rod).EI1);
  CHECK(section_properties(rod).draw_radius == Approx(0.15));
}

TEST_CASE("cross-section: the shear modulus, given or from Poisson's ratio") {
  const scenario::CrossSection circle = scenario::Circle{0.5};
  const scenario::Material given{kE, kDensity, std::nullopt, kG, {}};
  CHECK(section_properties(circle, given).GJ == Approx(of(circle).GJ).epsilon(1e-15));
}

}  // namespace
}  // namespace der
