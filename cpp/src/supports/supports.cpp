#include "der/supports/supports.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "der/model/location.hpp"
#include "der/scenario/support.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "der/supports/spring.hpp"

namespace der {
namespace {

constexpr std::array<const char*, 3> kComponentNames{"x", "y", "z"};

void hold(Model& model, Index dof, Index displacement, double weight = 1.0) {
  const auto known = std::find_if(model.held.begin(), model.held.end(),
                                  [&](const HeldDof& held) { return held.dof == dof; });
  if (known == model.held.end()) model.held.push_back({dof, displacement, weight});
}

/// The components that a support moves, each with the controls of all its nodes.
NamedControl named_motion(const std::string& name, std::size_t number, const Model& model) {
  NamedControl result{name, false, {}};
  auto& components = result.components;
  for (const PrescribedControl& moved : model.prescribed) {
    if (moved.support != number) continue;
    const auto known = std::find_if(
        components.begin(), components.end(),
        [&](const ControlComponent& component) { return component.name == moved.component; });
    if (known != components.end()) {
      known->controls.push_back(moved.control);
      continue;
    }
    const bool turns = moved.component == "angle" || moved.component == "twist";
    components.push_back({moved.component, turns ? "rad" : "m", {moved.control}});
  }
  return result;
}

/// Holds the rotation of a joint in space, or turns it about an axis that keeps its direction.
void hold_joint(const scenario::Support& support, std::size_t number, Index place,
                const RodMesh& rod, Model& model) {
  const Index rotation = rod.rotation_at(place);
  if (rotation < 0) return;
  Vec3 axis = Vec3::Zero();
  Index control = -1;
  if (support.axis_rotation) {
    axis = Eigen::Map<const Vec3>(support.axis_rotation->axis.data()).stableNormalized();
    control = model.tables.add(support.axis_rotation->angle);
  } else if (support.twist) {
    axis = initial_tangent(rod, place, model);
    control = model.tables.add(*support.twist);
  }
  for (Index c = 0; c < 3; ++c) {
    const bool turns = axis[c] != 0.0;
    hold(model, model.dofs.rotation(rotation) + c, turns ? control : -1, turns ? axis[c] : 1.0);
  }
  if (control >= 0)
    model.prescribed.push_back({number, support.twist ? "twist" : "angle", control});
}

/// Holds or moves the nodes of a support.
void hold_nodes(const scenario::Support& support, std::size_t number, Model& model) {
  RodMesh& rod = model.rod(support.rod);
  for (const Index place : nodes_at(support.at, rod)) {
    const Index node = rod.nodes[static_cast<std::size_t>(place)];
    for (const auto& [component, displacement] : support.prescribe) {
      const Index control = model.tables.add(displacement);
      hold(model, model.dof(node, static_cast<int>(component)), control);
      model.prescribed.push_back(
          {number, kComponentNames[static_cast<std::size_t>(component)], control});
    }
    for (const auto component : support.fix) {
      hold(model, model.dof(node, static_cast<int>(component)), -1);
    }
    if (support.clamps()) {
      for (int c = 0; c < model.dimension; ++c) {
        if (support.clamps(static_cast<scenario::Component>(c)))
          hold(model, model.dof(node, c), -1);
      }
      if (!rod.legs.empty() && model.dimension == 3) {
        hold_joint(support, number, place, rod, model);
        continue;
      }
      if (model.dimension == 3) {
        hold_section(support, place, rod, model);
        if (const Clamp* clamp = rod.clamp_at(place); clamp != nullptr) {
          if (clamp->held.rotation >= 0) {
            model.prescribed.push_back({number, "angle", clamp->held.rotation});
          }
          if (clamp->held.twist >= 0) {
            model.prescribed.push_back({number, "twist", clamp->held.twist});
          }
        }
        continue;
      }
      if (const Index rotation = rod.rotation_at(place); rotation >= 0) {
        const Index control = support.rotation ? model.tables.add(*support.rotation) : -1;
        hold(model, model.dofs.rotation(rotation), control);
        if (control >= 0) model.prescribed.push_back({number, "angle", control});
        continue;
      }
      hold_tangent(support, place, rod, model);
      const Clamp* clamp = rod.clamp_at(place);
      if (support.rotation && clamp != nullptr && clamp->rotation >= 0) {
        model.prescribed.push_back({number, "angle", clamp->rotation});
      }
    }
  }
}

}  // namespace

void add_support(const scenario::Support& support, std::size_t number, Model& model) {
  if (support.spring) add_spring(support, model);
  if (!support.holds()) return;
  hold_nodes(support, number, model);
  if (support.name.empty()) return;
  NamedControl motion = named_motion(support.name, number, model);
  if (!motion.components.empty()) model.named.push_back(std::move(motion));
}

}  // namespace der
