#include <algorithm>

#include "der/catalog/quantities.hpp"
#include "der/scenario/model_choice.hpp"
#include "scenario/checks.hpp"
#include "scenario/directions.hpp"

namespace der::scenario {
namespace {

struct ZeroOrNoNumber {
  bool operator()(double curvature) const { return curvature == 0.0; }
  bool operator()(const std::vector<double>& list) const { return is_zero(list); }
  template <class Other>
  bool operator()(const Other& /*curvature*/) const {
    return true;
  }
};

/// A number says on which side of a rod its curvature lies only where z and the tangent do.
void check_natural_curvature(const Rod& rod, const Path& path, Diagnostics& diagnostics) {
  if (std::visit(ZeroOrNoNumber{}, rod.natural_curvature)) return;
  if (is_flat(rod) && rod.initial_twist == 0.0) return;
  diagnostics.add(path / "natural_curvature",
                  "a number is a curvature about z, of a rod drawn without twist at one z: give a "
                  "pair [k1, k2], the curvatures toward the director and across it");
}

void check_twisting(const Rod& rod, const Path& path, const std::string& reason,
                    Diagnostics& diagnostics) {
  if (has_torsional_stiffness(rod)) return;
  const bool direct = std::holds_alternative<Stiffness>(rod.cross_section);
  diagnostics.add(
      direct ? path / "cross_section" / "stiffness" : path / "material",
      fmt::format("a rod of the model 'spatial' needs a stiffness against twisting: give {} (the "
                  "model: {})",
                  direct ? "'GJ'" : "'poissons_ratio' or 'shear_modulus'", reason));
}

bool is_of_bending(QuantityKind kind) {
  return kind == QuantityKind::Bend || kind == QuantityKind::Section ||
         kind == QuantityKind::Natural;
}

bool is_of_cable(const Probe& probe, const SceneText& scene) {
  return std::any_of(scene.rods.begin(), scene.rods.end(),
                     [&](const Rod& rod) { return probe.rod == rod.name && does_not_bend(rod); });
}

bool holds_section(const Probe& probe, const SceneText& scene) {
  return std::any_of(scene.supports.begin(), scene.supports.end(), [&](const Support& support) {
    return support.rod == probe.rod && support.clamp == Clamp::Section;
  });
}

/// A probe changes no model. What the chosen one does not have has to be asked for, but where it
/// was chosen for a scene in space: the values of the scene alone made it the smaller one, and they
/// do not change what its probes mean.
void check_quantities(const SceneText& scene, ModelChoice kind, Diagnostics& diagnostics) {
  for (const Probe& probe : scene.output.probes) {
    const Quantity& quantity = *find_quantity(probe.quantity);
    const int dimension = kind == ModelChoice::Planar ? 2 : 3;
    const Path path{"output", "probes", probe.name, "quantity"};
    const bool is_of_model = is_available_in(dimension, kind == ModelChoice::Spatial, quantity);
    const bool stands_for_space = scene.model == ModelChoice::Auto && scene.in_space;
    if (dimension == 2 && stands_for_space && is_of_plane(quantity)) {
      diagnostics.add(path, lacks_in_flat_scene(quantity));
    } else if (!is_of_model && !(stands_for_space && is_of_space(quantity))) {
      diagnostics.add(path, lacks(name_of(kind), quantity));
    } else if ((dimension == 3 || stands_for_space) && is_of_bending(quantity.kind) &&
               is_of_cable(probe, scene)) {
      diagnostics.add(path, fmt::format("rod '{}' has no stiffness against bending, EI: it has no "
                                        "'{}' in space",
                                        *probe.rod, probe.quantity));
    } else if (kind == ModelChoice::SpatialBend && quantity.is_towards_director &&
               !holds_section(probe, scene)) {
      diagnostics.add(path, lacks_held_section(*probe.rod, probe.quantity));
    }
  }
}

}  // namespace

void check_model(const SceneText& scene, const ChosenModel& model, Diagnostics& diagnostics) {
  const bool asked_for = scene.model != ModelChoice::Auto;
  if (const std::string obstacle = asked_for ? why_not(model.kind, scene) : std::string();
      !obstacle.empty()) {
    diagnostics.add({"model"},
                    fmt::format("'{}' cannot represent this scene: {}. Write 'auto' for the "
                                "smallest model that can",
                                name_of(model.kind), obstacle));
    return;
  }
  check_availability(scene, model.kind, diagnostics);
  check_quantities(scene, model.kind, diagnostics);
  if (model.kind == ModelChoice::Planar) return;
  for (int i = 0; i < static_cast<int>(scene.rods.size()); ++i) {
    const Rod& rod = scene.rods[static_cast<std::size_t>(i)];
    const Path path{"rods", i};
    check_natural_curvature(rod, path, diagnostics);
    if (model.kind == ModelChoice::Spatial) check_twisting(rod, path, model.reason, diagnostics);
  }
}

}  // namespace der::scenario
