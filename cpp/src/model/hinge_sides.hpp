#pragma once

#include <array>

#include "der/model/location.hpp"
#include "der/model/model.hpp"
#include "der/scenario/joint.hpp"

namespace der {

/// The degrees of freedom of the rotations of the two sides of a hinge that has a spring, a damping
/// or a moment between them.
inline std::array<Index, 2> hinge_sides(const scenario::Joint& joint, const Model& model) {
  const auto side = [&](const scenario::JointMember& member) {
    const RodMesh& rod = model.rod(member.rod);
    return model.dofs.rotation(rod.rotation_at(node_at(member.at, rod)));
  };
  return {side(joint.of[0]), side(joint.of[1])};
}

}  // namespace der
