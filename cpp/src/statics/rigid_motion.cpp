#include "der/statics/rigid_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
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

/// Displacements of a part as a rigid body, one a column: along x, along y, and turning about its
/// middle. Entries are up to about 1.
Eigen::MatrixX3d rigid_motions(const Model& model, const Vector& positions,
                               const std::vector<Index>& nodes) {
  const auto point = [&](Index node) -> Vec2 { return positions.segment<2>(model.dof(node, 0)); };
  Vec2 middle = Vec2::Zero();
  for (const Index node : nodes) middle += point(node) / static_cast<double>(nodes.size());
  Eigen::MatrixX3d motions = Eigen::MatrixX3d::Zero(model.num_dofs(), 3);
  for (const Index node : nodes) {
    const Vec2 arm = (point(node) - middle) / model.size();
    motions.row(model.dof(node, 0)) << 1.0, 0.0, -arm.y();
    motions.row(model.dof(node, 1)) << 0.0, 1.0, arm.x();
  }
  return motions;
}

/// Those combinations of rigid motions, one a column, that move no held degree of freedom.
std::vector<Eigen::Vector3d> permitted(const Model& model, const Eigen::MatrixX3d& motions) {
  constexpr double kStill = 1e-12;  // sum of the squares of what is held
  Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
  for (const HeldDof& dof : model.held) {
    held += motions.row(dof.dof).transpose() * motions.row(dof.dof);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(held);
  std::vector<Eigen::Vector3d> found;
  for (int i = 0; i < 3; ++i) {
    if (solver.eigenvalues()[i] <= kStill) found.emplace_back(solver.eigenvectors().col(i));
  }
  return found;
}

/// d' K d [J] of springs and foundations for a displacement d over all degrees of freedom [m].
double spring_variation(const Model& model, const Configuration& here, const Vector& displacement) {
  double total = 0.0;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (Kernel::kTerm == EnergyTerm::Spring) {
      LocalTerm<Kernel::kDofs> local;
      for (std::size_t e = 0; e < list.size(); ++e) {
        Kernel::template evaluate<Derivatives::Hessian>(
            list.constants[e], here, gather(list.dofs[e], here.coordinates), local);
        const auto moved = gather(list.dofs[e], displacement);
        total += moved.dot(local.hessian * moved);
      }
    }
  });
  return total;
}

const char* motion_in_words(const Eigen::Vector3d& combination) {
  constexpr std::array kWords{"moving along x", "moving along y", "turning"};
  Eigen::Index largest = 0;
  combination.cwiseAbs().maxCoeff(&largest);
  return kWords[static_cast<std::size_t>(largest)];
}

}  // namespace

std::string find_weakly_held_part(const Model& model, const Configuration& here, double rounding) {
  if (model.dimension != 2) return "";  // `rigid_motions` has those of the plane alone
  const std::vector<Index> part = connected_parts(model);
  std::map<Index, std::vector<Index>> nodes_of_part;
  for (Index node = 0; node < model.num_nodes; ++node) {
    nodes_of_part[part[to_size(node)]].push_back(node);
  }
  for (const auto& [first, nodes] : nodes_of_part) {
    const Eigen::MatrixX3d motions = rigid_motions(model, here.coordinates, nodes);
    for (const Eigen::Vector3d& combination : permitted(model, motions)) {
      const Vector motion = motions * combination;
      const double stiffness = spring_variation(model, here, motion);
      if (stiffness <= 0.0 || stiffness >= rounding * motion.squaredNorm()) continue;
      return fmt::format(
          "springs or foundations alone hold rod '{}' against {}, with {:.3g} N/m, which is lost "
          "in the rounding errors of its stiffness against stretching",
          place_of(model, first).rod, motion_in_words(combination), stiffness);
    }
  }
  return "";
}

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
