#include "statics/equilibrium/free_spin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include "der/supports/section_spring.hpp"

namespace der::statics {
namespace {

constexpr double kRounding = 1e-9;

/// Springs that hold a rod against spinning about one of its tangents.
bool has_springs(const RodMesh& rod) {
  const bool pulls =
      std::any_of(rod.force_places.begin(), rod.force_places.end(),
                  [](const ForcePlace& place) { return !place.stiffness.isZero(0.0); });
  const bool twists =
      std::any_of(rod.section_springs.begin(), rod.section_springs.end(),
                  [](const SectionSpringPlace& place) { return place.stiffness.z() > 0.0; });
  return pulls || twists || !rod.foundation_places.empty();
}

/// The drawn tangents that clamps hold, and springs against turning across them.
std::vector<Vec3> held_tangents(const RodMesh& rod, const Model& model) {
  std::vector<Vec3> tangents;
  for (const Clamp& clamp : rod.clamps) tangents.push_back(clamp.held.drawn.tangent);
  for (const SectionSpringPlace& place : rod.section_springs) {
    std::visit([&](const auto& springs) { tangents.push_back(springs.spring.drawn.tangent); },
               held_section_at(place.arc_length, rod, model));
  }
  return tangents;
}

/// A node that supports hold in all directions.
std::optional<Vec3> find_held_point(const RodMesh& rod, const Model& model) {
  const auto held = [&](Index node) {
    return !model.dofs.is_free(model.dof(node, 0)) && !model.dofs.is_free(model.dof(node, 1)) &&
           !model.dofs.is_free(model.dof(node, 2));
  };
  const auto found = std::find_if(rod.nodes.begin(), rod.nodes.end(), held);
  if (found == rod.nodes.end()) return std::nullopt;
  return model.initial_positions.segment<3>(model.dof(*found, 0));
}

/// Whether turning about an axis through `origin` moves none of the places that supports hold.
bool may_turn_about(const Vec3& axis, const Vec3& origin, const RodMesh& rod, const Model& model) {
  return std::all_of(rod.nodes.begin(), rod.nodes.end(), [&](Index node) {
    const Vec3 point = model.initial_positions.segment<3>(model.dof(node, 0));
    const Vec3 motion = axis.cross(point - origin);
    for (int c = 0; c < 3; ++c) {
      const bool held = !model.dofs.is_free(model.dof(node, c));
      if (held && std::abs(motion[c]) > kRounding * model.size()) return false;
    }
    return true;
  });
}

bool spins_freely(const RodMesh& rod, const Model& model) {
  const auto holds = [](const Clamp& clamp) { return clamp.holds_section; };
  if (std::any_of(rod.clamps.begin(), rod.clamps.end(), holds) || has_springs(rod)) return false;
  const std::vector<Vec3> tangents = held_tangents(rod, model);
  const std::optional<Vec3> origin = find_held_point(rod, model);
  if (tangents.empty() || !origin) return false;
  const Vec3& axis = tangents.front();
  const bool are_parallel = std::all_of(tangents.begin(), tangents.end(), [&](const Vec3& tangent) {
    return axis.cross(tangent).norm() <= kRounding;
  });
  return are_parallel && may_turn_about(axis, *origin, rod, model);
}

}  // namespace

std::string find_free_spin(const Model& model) {
  if (!model.has_sections()) return "";
  for (const RodMesh& rod : model.rods) {
    if (!spins_freely(rod, model)) continue;
    return fmt::format(
        "rod '{}' spins freely about the tangent that its clamp holds; write 'clamp: true', which "
        "holds the section, too, or add a spring with a 'rotational_stiffness' at another place",
        rod.name);
  }
  return "";
}

}  // namespace der::statics
