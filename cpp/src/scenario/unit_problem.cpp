#include "der/scenario/unit_problem.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
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

/// A metal or a stone, in whose modulus [Pa] so small a number counts GPa.
constexpr double kHeavy = 2e3;  // [kg/m^3]
constexpr double kFewGPa = 2e3;

/// Metals, stones and glass, in which sound goes along a bar at 1200 (lead) to 13000 m/s
/// (beryllium). Elastomers become as heavy by a third of metal powder, which makes them three times
/// as stiff: 6 m/s and more.
constexpr double kStone = 2500.0;   // [kg/m^3]
constexpr double kSlowest = 6.0;    // [m/s]
constexpr double kSlowInMPa = 0.5;  // [m/s] slower ones are in GPa

/// Strain that the loads cause if each pulls along its rod with all of its force. It is 1 where
/// the linear law has no meaning; supports, buoyancy and foundations may well bear nine tenths.
constexpr double kStrain = 10.0;

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

double largest_of(const VectorSeries& series) {
  double largest = 0.0;
  for (const Components& value : series.values) {
    double squares = 0.0;
    for (const double component : value) squares += component * component;
    largest = std::max(largest, std::sqrt(squares));
  }
  return largest;
}

/// What pulls on the rods of a scene: gravity [m/s^2], and by the name of a rod the sum of forces
/// [N]. A foundation bears what it may.
struct Pull {
  double gravity = 0.0;
  std::unordered_map<std::string, double> forces{};
  std::unordered_set<std::string> borne{};

  void operator()(const Gravity& load) { gravity += largest_of(load.acceleration); }
  void operator()(const PointForce& load) { forces[load.rod] += largest_of(load.force); }
  void operator()(const DistributedForce& load) {
    forces[load.rod] += largest_of(load.force) * (load.to - load.from);
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
      return fmt::format(
          "is thicker ({:.4g} m) than long ({:.4g} m). Is its cross-section in mm? '{}' then is "
          "{:.6g}",
          size.thickness, length, size.key, 1e-3 * size.value);
    }
    if (!rod.material) return {};
    const Material& material = *rod.material;
    if (material.youngs_modulus < kSoftest) {
      return fmt::format(
          "is softer than any solid: its modulus is {:g} Pa. Is it in MPa? 'youngs_modulus' then "
          "is {:g}",
          material.youngs_modulus, 1e6 * material.youngs_modulus);
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
          "is lighter than any solid{}: its density is {:g} kg/m^3. Is it in g/cm^3? 'density' "
          "then is {:g}",
          density < kLightest ? "" : " of its stiffness", density, 1e3 * density);
    }
    if (density <= kHeaviest) return {};
    return fmt::format(
        "is heavier than any solid: its density is {:g} kg/m^3. Is it in g/m^3? 'density' then is "
        "{:g}",
        density, 1e-3 * density);
  }

  [[nodiscard]] std::string strain_problem(const Rod& rod, double length) const {
    const Material& material = *rod.material;
    if (pull_.borne.count(rod.name) > 0) return {};
    const auto found = pull_.forces.find(rod.name);
    const double force = found == pull_.forces.end() ? 0.0 : found->second;
    const double weight = material.density * pull_.gravity * length / material.youngs_modulus;
    const double strain = weight + force / (material.youngs_modulus * area_of(rod.cross_section));
    if (!(strain > kStrain)) return {};
    struct Unit {
      const char* name;
      double factor;
    };
    static constexpr std::array<Unit, 3> units{{{"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}}};
    constexpr double sound = 0.1;  // a strain that is not absurd
    const bool is_metal = material.density > kHeavy && material.youngs_modulus < kFewGPa;
    const auto* unit = std::find_if(units.begin(), units.end() - 1, [&](const Unit& candidate) {
      return !is_metal && strain < sound * candidate.factor;
    });
    return fmt::format(
        "would be strained by {:.2g} if its loads pulled along it, where no material is linear "
        "beyond 1. Is its modulus in {}? 'youngs_modulus' then is {:g}. Else look at the units of "
        "its lengths (m) and loads (N)",
        strain, unit->name, unit->factor * material.youngs_modulus);
  }

  /// A gel is as soft and a metal is as heavy, and nothing is both.
  static std::string softness_problem(const Material& material) {
    if (material.density < kStone) return {};
    const double speed = std::sqrt(material.youngs_modulus / material.density);
    if (speed >= kSlowest) return {};
    const bool in_MPa = speed >= kSlowInMPa;
    return fmt::format(
        "is as heavy as metal or stone ({:g} kg/m^3) and as soft as a gel: its modulus is {:g} Pa. "
        "Is it in {}? 'youngs_modulus' then is {:g}",
        material.density, material.youngs_modulus, in_MPa ? "MPa" : "GPa",
        (in_MPa ? 1e6 : 1e9) * material.youngs_modulus);
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
