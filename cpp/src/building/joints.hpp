#pragma once

#include <cstddef>
#include <vector>

#include "der/model/model.hpp"

namespace der {

namespace scenario {
struct Scene;
}

/// A node of a rod of the scene.
struct JoinedPlace {
  std::size_t rod = 0;
  Index place = 0;  ///< position in its nodes
};
/// The places that each joint of a scene joins.
std::vector<std::vector<JoinedPlace>> joined_places(const scenario::Scene& scene);

/// Finds the joints of a scene that has any: makes the legs of all rods, which are laid out, and
/// enters the rotations of joints among the degrees of freedom. Legs end at joints, and wherever
/// else a support, a load or a sphere acts at a point, at corners, and at the ends of rods.
void find_joints(const scenario::Scene& scene, Model& model);

}  // namespace der
