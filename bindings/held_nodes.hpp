#pragma once

#include <optional>
#include <string>
#include <vector>

#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/scenario/scenario.hpp"

namespace der::python {

/// A node that a support of the scene holds, for drawings.
struct HeldNode {
  std::string rod;
  Index node = 0;
  std::vector<std::string> components;  ///< held or moved by a table: x, y, z
  std::optional<double> tangent_angle;  ///< [rad] from the x axis, of a clamp
};

/// All of them, in the order of the supports, with the clamps turned as they are in a state.
std::vector<HeldNode> held_nodes(const scenario::Scene& scene, const Model& model,
                                 const State& state);

}  // namespace der::python
