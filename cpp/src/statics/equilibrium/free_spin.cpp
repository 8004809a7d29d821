#include "statics/equilibrium/free_spin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace der::statics {
namespace {

bool has_springs(const RodLayout& rod) {
  const bool pulls =
      std::any_of(rod.force_places.begin(), rod.force_places.end(),
                  [](const ForcePlace& place) { return !place.stiffness.isZero(0.0); });
  return pulls || !rod.section_springs.empty() || !rod.foundation_places.empty();
}

/// Whether turning about an axis through `origin` moves none of the places that supports hold, and
/// turns no clamped tangent.
bool may_turn_about(const Vec3& axis, const Vec3& origin, const RodLayout& rod,
                    const Model& model) {
  constexpr double kRounding = 1e-9;
  for (const Clamp& clamp : rod.clamps) {
    if (axis.cross(clamp.held.drawn.tangent).norm() > kRounding) return false;
  }
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

bool spins_freely(const RodLayout& rod, const Model& model) {
  if (rod.clamps.empty() || has_springs(rod)) return false;
  const auto holds = [](const Clamp& clamp) { return clamp.holds_section; };
  if (std::any_of(rod.clamps.begin(), rod.clamps.end(), holds)) return false;
  const Clamp& first = rod.clamps.front();
  const Vec3 origin = model.initial_positions.segment<3>(model.dof(rod.node(first.place), 0));
  return may_turn_about(first.held.drawn.tangent, origin, rod, model);
}

}  // namespace

std::string find_free_spin(const Model& model) {
  if (!model.has_sections()) return "";
  for (const RodLayout& rod : model.rods) {
    if (!spins_freely(rod, model)) continue;
    return fmt::format(
        "rod '{}' spins freely about the tangent that its clamp holds; write 'clamp: true', which "
        "holds the section, too, or add a spring with a 'rotational_stiffness' at another place",
        rod.name);
  }
  return "";
}

}  // namespace der::statics
