#include "building/force_nodes.hpp"

#include <cmath>
#include <variant>

#include "der/core/index.hpp"
#include "der/core/nearest_node.hpp"
#include "der/model/location.hpp"
#include "der/scenario/load.hpp"

namespace der {
namespace {

void enter(const std::string& name, const scenario::Location& at, Model& model) {
  RodLayout& rod = model.rod(name);
  for (const double s : arc_lengths_of(at, rod)) {
    const std::size_t node = to_size(nearest_node(rod.arc_length, s));
    if (std::abs(rod.arc_length[node] - s) <= rod.same_place()) rod.bears_force[node] = true;
  }
}

bool bears_force(const scenario::Support& support) {
  return support.holds() || (support.spring && !support.spring->stiffness.empty());
}

}  // namespace

void find_force_nodes(const scenario::Scene& scene, Model& model) {
  for (RodLayout& rod : model.rods) {
    rod.bears_force.assign(rod.nodes.size(), false);
    for (std::size_t i = 0; i < rod.nodes.size(); ++i) {
      rod.bears_force[i] = rod.sphere_radius[i] > 0.0;
    }
  }
  for (const scenario::Support& support : scene.supports) {
    if (bears_force(support)) enter(support.rod, support.at, model);
  }
  for (const auto& load : scene.loads) {
    const auto* force = std::get_if<scenario::PointForce>(&load.what);
    // One on every node is distributed: its jumps are as small as those of gravity.
    if (force == nullptr || force->at.kind == scenario::Location::Kind::All) continue;
    enter(force->rod, force->at, model);
  }
}

}  // namespace der
