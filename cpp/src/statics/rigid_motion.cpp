#include "der/statics/rigid_motion.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "der/core/index.hpp"
#include "der/energies/registry.hpp"

namespace der {
namespace {

/// Nodes that are connected by elements: for each node the first of its part.
std::vector<Index> connected_parts(const Model& model) {
  std::vector<Index> parent(to_size(model.num_nodes));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index node) {
    while (parent[to_size(node)] != node)
      node = parent[to_size(node)] = parent[to_size(parent[to_size(node)])];
    return node;
  };
  for_each_list(*model.elements, [&](const auto& list) {
    for (const auto& dofs : list.dofs) {
      for (const Index dof : dofs) {
        const Index a = root(model.dofs.node_of(dofs.front()));
        const Index b = root(model.dofs.node_of(dof));
        parent[to_size(std::max(a, b))] = std::min(a, b);
      }
    }
  });
  for (Index node = 0; node < model.num_nodes; ++node) parent[to_size(node)] = root(node);
  return parent;
}

/// Marks the parts that a spring holds in one component.
void mark_held_by_springs(const Model& model, int component, const std::vector<Index>& part,
                          std::vector<char>& held) {
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (HoldsElement<Kernel>::value) {
      for (std::size_t e = 0; e < list.size(); ++e) {
        if (Kernel::holding_stiffness(list.constants[e], component) == 0.0) continue;
        held[to_size(part[to_size(model.dofs.node_of(list.dofs[e].front()))])] = 1;
      }
    }
  });
}

}  // namespace

std::string find_unheld_part(const Model& model, const Vector& force) {
  constexpr double kBalance = 1e-9;  // of the forces that act
  const std::vector<Index> part = connected_parts(model);
  for (int c = 0; c < model.dimension; ++c) {
    std::vector<char> held(to_size(model.num_nodes), 0);
    std::vector<double> net(to_size(model.num_nodes), 0.0);
    std::vector<double> acting(to_size(model.num_nodes), 0.0);
    for (Index node = 0; node < model.num_nodes; ++node) {
      const Index dof = model.dof(node, c);
      const std::size_t first = to_size(part[to_size(node)]);
      if (!model.dofs.is_free(dof)) held[first] = 1;
      net[first] += force[dof];
      acting[first] += std::abs(force[dof]);
    }
    mark_held_by_springs(model, c, part, held);
    for (Index node = 0; node < model.num_nodes; ++node) {
      const std::size_t i = to_size(node);
      if (held[i] != 0 || std::abs(net[i]) <= kBalance * acting[i]) continue;
      return fmt::format(
          "no support holds rod '{}' in {}, and {:.3g} N act on it in that direction",
          place_of(model, node).rod, "xyz"[c], net[i]);
    }
  }
  return "";
}

}  // namespace der
