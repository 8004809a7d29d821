#include "der/scenario/unit_problem.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <unordered_map>
#include <unordered_set>

#include "der/core/constants.hpp"
#include "der/scenario/load.hpp"
#include "scenario/rest_line.hpp"

// The bounds leave room for whatever has been built or grown.
namespace der::scenario {
namespace {

/// The softest gels and mucus have some Pa.
constexpr double kSoftest = 5.0;  // [Pa]
/// Solids weigh 0.16 (graphene aerogel) to 22590 kg/m^3 (osmium).
constexpr double kLightest = 0.1;  // [kg/m^3]
constexpr double kHeaviest = 3e4;  // [kg/m^3]
/// A solid lighter than balsa is a foam or a lattice, whose modulus goes with the square of its
/// density. The stiffest have: 41 MPa at 24 kg/m^3 (aramid honeycomb), 5 MPa at 15 (polystyrene
/// foam), below 0.1 MPa at 1 (metal microlattices, aerogels).
constexpr double kFoam = 25.0;         // [kg/m^3]
constexpr double kStiffestFoam = 1e5;  // [Pa] at 1 kg/m^3

/// Elastomers have 10 kPa and more, diamond 1.2 TPa. Softer solids there are, but few would count
/// their modulus in MPa or GPa.
constexpr double kLikelySoft = 1e4;      // [Pa]
constexpr double kLikelyStiff = 1.3e12;  // [Pa]
/// From a light foam to osmium.
constexpr double kLikelyLight = 25.0;  // [kg/m^3]

/// Metals, stones and glass, in which sound goes along a bar at 1200 (lead) to 13000 m/s
/// (beryllium). Elastomers become as heavy by a third of metal powder, which makes them three times
/// as stiff: 6 m/s and more.
constexpr double kStone = 2500.0;   // [kg/m^3]
constexpr double kSlowest = 6.0;    // [m/s]
constexpr double kSlowSolid = 1e3;  // [m/s] none of them is slower

/// Strain that the loads cause if each pulls along its rod with all of its force. It is 1 where
/// the linear law has no meaning; supports, buoyancy and foundations may well bear nine tenths.
constexpr double kStrain = 10.0;

struct OtherUnit {
  const char* name;
  double factor;
};

/// "Is it in MPa? 'youngs_modulus' then is 1e+06", with the first unit in which the number is a
/// likely one; else where to look.
template <class IsLikely>
std::string likely_unit(const char* what, const char* key, const char* si, double value,
                        std::initializer_list<OtherUnit> units, IsLikely&& is_likely) {
  for (const OtherUnit& unit : units) {
    if (!is_likely(unit.factor * value)) continue;
    return fmt::format("Is {} in {}? '{}' then is {:.6g}", what, unit.name, key,
                       unit.factor * value);
  }
  return fmt::format("No unit makes '{}' a likely number: it is read in {}", key, si);
}

bool is_likely_modulus(double modulus, double density) {
  if (modulus < kLikelySoft || modulus > kLikelyStiff) return false;
  return density < kStone || std::sqrt(modulus / density) >= kSlowSolid;
}

bool is_likely_density(double density) { return density >= kLikelyLight && density <= kHeaviest; }

struct Size {
  const char* key;
  double value;      // [m]
  double thickness;  // [m]
};

Size largest_size(const CrossSection& section) {
  struct Visitor {
    Size operator()(const Circle& circle) const {
      return {"radius", circle.radius, 2.0 * circle.radius};
    }
    Size operator()(const Tube& tube) const {
      return {"outer_radius", tube.outer_radius, 2.0 * tube.outer_radius};
    }
    Size operator()(const Rectangle& sides) const { return of_sides(sides.width, sides.height); }
    Size operator()(const Ellipse& axes) const { return of_sides(axes.width, axes.height); }
    Size operator()(const Stiffness& /*direct*/) const { return {"", 0.0, 0.0}; }
    static Size of_sides(double width, double height) {
      // A plate may be wider than long; its height is what bends.
      return {"height", height, std::min(width, height)};
    }
  };
  return std::visit(Visitor{}, section);
}

double area_of(const CrossSection& section) {
  struct Visitor {
    double operator()(const Circle& circle) const { return kPi * circle.radius * circle.radius; }
    double operator()(const Tube& tube) const {
      return kPi * (tube.outer_radius - tube.inner_radius) *
             (tube.outer_radius + tube.inner_radius);
    }
    double operator()(const Rectangle& sides) const { return sides.width * sides.height; }
    double operator()(const Ellipse& axes) const { return 0.25 * kPi * axes.width * axes.height; }
    double operator()(const Stiffness& /*direct*/) const { return 0.0; }
  };
  return std::visit(Visitor{}, section);
}

/// The smaller second moment of area [m^4].
double inertia_of(const CrossSection& section) {
  struct Visitor {
    double operator()(const Circle& circle) const {
      return 0.25 * kPi * std::pow(circle.radius, 4);
    }
    double operator()(const Tube& tube) const {
      return 0.25 * kPi * (std::pow(tube.outer_radius, 4) - std::pow(tube.inner_radius, 4));
    }
    double operator()(const Rectangle& sides) const {
      const auto [least, other] = std::minmax(sides.width, sides.height);
      return std::pow(least, 3) * other / 12.0;
    }
    double operator()(const Ellipse& axes) const {
      const auto [least, other] = std::minmax(axes.width, axes.height);
      return kPi * std::pow(least, 3) * other / 64.0;
    }
    double operator()(const Stiffness& /*direct*/) const { return 0.0; }
  };
  return std::visit(Visitor{}, section);
}

double largest_of(const VectorSeries& series) {
  double largest = 0.0;
  for (const Components& value : series.values) {
    double squares = 0.0;
    for (const double component : value) squares += component * component;
    largest = std::max(largest, std::sqrt(squares));
  }
  return largest;
}

/// What loads the rods of a scene: gravity [m/s^2], and by the name of a rod the sums of forces [N]
/// and of moments. A foundation bears what it may.
struct Pull {
  double gravity = 0.0;
  std::unordered_map<std::string, double> forces{};
  std::unordered_map<std::string, double> moments{};  ///< [N m]
  std::unordered_set<std::string> borne{};

  void operator()(const Gravity& load) { gravity += largest_of(load.acceleration); }
  void operator()(const PointForce& load) { forces[load.rod] += largest_of(load.force); }
  void operator()(const DistributedForce& load) {
    forces[load.rod] += largest_of(load.force) * (load.to - load.from);
  }
  void operator()(const Moment& load) {
    double largest = largest_of(load.moment_vector);
    for (const double value : load.moment.values) largest = std::max(largest, std::abs(value));
    moments[load.rod] += largest;
  }
  void operator()(const Foundation& load) { borne.insert(load.rod); }
  template <class Other>
  void operator()(const Other& /*load*/) {}
};

class Units {
 public:
  Units(const Scene& scene, Pull pull) : scene_(scene), pull_(std::move(pull)) {}

  /// Says what is wrong with the numbers of a rod, and which unit is likely; empty: nothing.
  [[nodiscard]] std::string problem(const Rod& rod, double length) const {
    const Size size = largest_size(rod.cross_section);
    if (size.thickness > length) {
      const auto is_thin = [&](double value) {
        return value * size.thickness < length * size.value;
      };
      return fmt::format("is thicker ({:.4g} m) than long ({:.4g} m). {}", size.thickness, length,
                         likely_unit("its cross-section", size.key, "m", size.value,
                                     {{"mm", 1e-3}, {"um", 1e-6}}, is_thin));
    }
    if (!rod.material) return {};
    const Material& material = *rod.material;
    const auto is_modulus = [&](double value) {
      return is_likely_modulus(value, material.density);
    };
    if (material.youngs_modulus < kSoftest) {
      return fmt::format("is softer than any solid: its modulus is {:g} Pa. {}",
                         material.youngs_modulus,
                         likely_unit("it", "youngs_modulus", "Pa", material.youngs_modulus,
                                     {{"MPa", 1e6}, {"GPa", 1e9}}, is_modulus));
    }
    if (std::string density = density_problem(material); !density.empty()) return density;
    if (std::string strain = strain_problem(rod, length); !strain.empty()) return strain;
    return softness_problem(material);
  }

 private:
  [[nodiscard]] std::string density_problem(const Material& material) const {
    const double density = material.density;
    const bool counts = scene_.is_dynamic() || pull_.gravity > 0.0 ||
                        std::holds_alternative<ModesAnalysis>(scene_.analysis);
    if (!counts || density == 0.0) return {};
    const bool too_stiff =
        density < kFoam && material.youngs_modulus > kStiffestFoam * density * density;
    if (density < kLightest || too_stiff) {
      return fmt::format(
          "is lighter than any solid{}: its density is {:g} kg/m^3. {}",
          density < kLightest ? "" : " of its stiffness", density,
          likely_unit("it", "density", "kg/m^3", density,
                      {{"g/cm^3", 1e3}, {"kg/cm^3", 1e6}, {"kg/mm^3", 1e9}, {"t/mm^3", 1e12}},
                      is_likely_density));
    }
    if (density <= kHeaviest) return {};
    return fmt::format(
        "is heavier than any solid: its density is {:g} kg/m^3. {}", density,
        likely_unit("it", "density", "kg/m^3", density, {{"g/m^3", 1e-3}}, is_likely_density));
  }

  [[nodiscard]] std::string strain_problem(const Rod& rod, double length) const {
    const Material& material = *rod.material;
    if (pull_.borne.count(rod.name) > 0) return {};
    const auto found = pull_.forces.find(rod.name);
    const double force = found == pull_.forces.end() ? 0.0 : found->second;
    const double weight = material.density * pull_.gravity * length / material.youngs_modulus;
    const double pulled = weight + force / (material.youngs_modulus * area_of(rod.cross_section));
    const double bent = strain_of_moments(rod);
    const double strain = std::max(pulled, bent);
    if (!(strain > kStrain)) return {};
    constexpr double sound = 0.1;  // a strain that is not absurd
    const auto is_modulus = [&](double value) {
      return is_likely_modulus(value, material.density) &&
             strain * material.youngs_modulus < sound * value;
    };
    return fmt::format(
        "would be strained by {:.2g} if its {}, where no material is linear beyond 1. {}. Or "
        "look at the units of its lengths (m) and loads (N, N m)",
        strain, pulled >= bent ? "loads pulled along it" : "moments bent it",
        likely_unit("its modulus", "youngs_modulus", "Pa", material.youngs_modulus,
                    {{"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}}, is_modulus));
  }

  /// M r / EI, r half the height.
  [[nodiscard]] double strain_of_moments(const Rod& rod) const {
    const auto found = pull_.moments.find(rod.name);
    const double inertia = inertia_of(rod.cross_section);
    if (found == pull_.moments.end() || inertia == 0.0) return 0.0;
    const double half = 0.5 * largest_size(rod.cross_section).thickness;
    return found->second * half / (rod.material->youngs_modulus * inertia);
  }

  /// A gel is as soft and a metal is as heavy, and nothing is both.
  static std::string softness_problem(const Material& material) {
    if (material.density < kStone) return {};
    const double speed = std::sqrt(material.youngs_modulus / material.density);
    if (speed >= kSlowest) return {};
    const auto is_modulus = [&](double value) {
      return is_likely_modulus(value, material.density);
    };
    return fmt::format(
        "is as heavy as metal or stone ({:g} kg/m^3) and as soft as a gel: its modulus is {:g} Pa. "
        "{}",
        material.density, material.youngs_modulus,
        likely_unit("it", "youngs_modulus", "Pa", material.youngs_modulus,
                    {{"MPa", 1e6}, {"GPa", 1e9}}, is_modulus));
  }

  const Scene& scene_;
  Pull pull_;
};

}  // namespace

std::string unit_problem(const Scene& scene) {
  Pull pull;
  for (const Load& load : scene.loads) std::visit(pull, load.what);
  const Units units(scene, std::move(pull));
  for (const Rod& rod : scene.rods) {
    const std::string problem =
        units.problem(rod, RestLine(rod.points, rod.closed, rod.rest_length).length());
    if (!problem.empty()) return fmt::format("rod '{}' {}", rod.name, problem);
  }
  return {};
}

}  // namespace der::scenario
