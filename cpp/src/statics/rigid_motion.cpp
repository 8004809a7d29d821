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

/// A structure as a rigid body: along each axis, and turning in the plane or about each axis.
template <int Dimension>
struct RigidBody;
template <>
struct RigidBody<2> {
  static constexpr std::array kMotions{"moving along x", "moving along y", "turning"};
  /// How `arm` [-] moves, a column for each way of turning.
  static Vec2 turned(const Vec2& arm) { return {-arm.y(), arm.x()}; }
};
template <>
struct RigidBody<3> {
  static constexpr std::array kMotions{"moving along x",  "moving along y",  "moving along z",
                                       "turning about x", "turning about y", "turning about z"};
  static Mat3 turned(const Vec3& arm) { return -cross_matrix(arm); }
};

template <int Dimension>
class RigidMotions {
 public:
  static constexpr int kCount = static_cast<int>(RigidBody<Dimension>::kMotions.size());
  using Combination = Eigen::Matrix<double, kCount, 1>;

  /// Those of the part with `nodes`. `part`: for each node the first of its part.
  RigidMotions(const Model& model, const Configuration& here, const std::vector<Index>& part,
               const std::vector<Index>& nodes)
      : model_(model), part_(part), first_(part[to_size(nodes.front())]) {
    displace(here.coordinates, nodes);
    turn_sections(here);
  }

  /// Displacements of all degrees of freedom [m, rad], one motion a column. Turning is scaled by
  /// the size of the model, so that entries are up to about 1.
  [[nodiscard]] const Eigen::Matrix<double, Eigen::Dynamic, kCount>& columns() const {
    return columns_;
  }

  /// Those combinations that move no held degree of freedom and turn no clamped tangent.
  [[nodiscard]] std::vector<Combination> permitted(const Vector& controls) const {
    constexpr double kStill = 1e-12;  // sum of the squares of what is held
    Eigen::Matrix<double, kCount, kCount> held = Eigen::Matrix<double, kCount, kCount>::Zero();
    for (const HeldDof& dof : model_.held) {
      held += columns_.row(dof.dof).transpose() * columns_.row(dof.dof);
    }
    for (const RodMesh& rod : model_.rods) {
      if (part_[to_size(rod.nodes.front())] != first_) continue;
      for (const Clamp& clamp : rod.clamps) held += turned_tangent(clamp, controls);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kCount, kCount>> solver(held);
    std::vector<Combination> found;
    for (int i = 0; i < kCount; ++i) {
      if (solver.eigenvalues()[i] <= kStill) found.emplace_back(solver.eigenvectors().col(i));
    }
    return found;
  }

  static const char* in_words(const Combination& combination) {
    Eigen::Index largest = 0;
    combination.cwiseAbs().maxCoeff(&largest);
    return RigidBody<Dimension>::kMotions[static_cast<std::size_t>(largest)];
  }

 private:
  using Vec = Eigen::Matrix<double, Dimension, 1>;
  static constexpr int kTurns = kCount - Dimension;

  void displace(const Vector& positions, const std::vector<Index>& nodes) {
    const auto point = [&](Index node) -> Vec {
      return positions.segment<Dimension>(model_.dof(node, 0));
    };
    Vec middle = Vec::Zero();
    for (const Index node : nodes) middle += point(node) / static_cast<double>(nodes.size());
    columns_.setZero(model_.num_dofs(), kCount);
    for (const Index node : nodes) {
      auto rows = columns_.template middleRows<Dimension>(model_.dof(node, 0));
      rows.template leftCols<Dimension>().setIdentity();
      rows.template rightCols<kTurns>() =
          RigidBody<Dimension>::turned((point(node) - middle) / model_.size());
    }
  }

  /// Joints turn with their rods. A section that turns with its rod turns about its tangent by the
  /// rotation's component along it: its reference frame, transported in parallel, does not.
  void turn_sections(const Configuration& here) {
    if constexpr (Dimension == 2) {
      for (Index i = 0; i < model_.dofs.num_rotations(); ++i) {
        const Index rotation = model_.dofs.rotation(i);
        if (part_[to_size(model_.dofs.node_of(rotation))] != first_) continue;
        columns_(rotation, Dimension) = 1.0 / model_.size();
      }
    }
    if constexpr (Dimension == 3) {
      for (Index i = 0; i < model_.dofs.num_rotations(); i += 3) {
        const Index rotation = model_.dofs.rotation(i);
        if (part_[to_size(model_.dofs.node_of(rotation))] != first_) continue;
        columns_.template block<3, 3>(rotation, Dimension) = Mat3::Identity() / model_.size();
      }
      for (const SpatialEdge& edge : model_.framed_edges) {
        if (part_[to_size(model_.dofs.node_of(edge.start))] != first_) continue;
        const Vec3 tangent = edge.vector(here.coordinates, here.controls).normalized();
        columns_.row(edge.theta).template tail<3>() = tangent.transpose() / model_.size();
      }
    }
  }

  /// Squares of the changes of a clamped tangent [-].
  [[nodiscard]] static Eigen::Matrix<double, kCount, kCount> turned_tangent(
      const Clamp& clamp, const Vector& controls) {
    Eigen::Matrix<double, kCount, kCount> squares = Eigen::Matrix<double, kCount, kCount>::Zero();
    auto turning = squares.template bottomRightCorner<kTurns, kTurns>();
    if constexpr (Dimension == 2) {
      turning.setOnes();
    } else {
      const Vec3 tangent = clamp.held.tangent(controls);
      turning = Mat3::Identity() - tangent * tangent.transpose();
    }
    return squares;
  }

  const Model& model_;
  const std::vector<Index>& part_;
  Index first_;
  Eigen::Matrix<double, Eigen::Dynamic, kCount> columns_;
};

/// d' K d [J] of springs and foundations for a displacement d over all degrees of freedom [m].
double spring_variation(const Model& model, const Configuration& here, const Vector& displacement) {
  double total = 0.0;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (Kernel::kTerm == EnergyTerm::Spring) {
      LocalTerm<Kernel::kDofs> local;
      for (std::size_t e = 0; e < list.size(); ++e) {
        evaluate_element<Kernel, Derivatives::Hessian>(
            list.constants[e], here, gather(list.dofs[e], here.coordinates), local);
        const auto moved = gather(list.dofs[e], displacement);
        total += moved.dot(local.hessian * moved);
      }
    }
  });
  return total;
}

template <int Dimension>
std::string find_weakly_held(const Model& model, const Configuration& here, double rounding) {
  const std::vector<Index> part = connected_parts(model);
  std::map<Index, std::vector<Index>> nodes_of_part;
  for (Index node = 0; node < model.num_nodes; ++node) {
    nodes_of_part[part[to_size(node)]].push_back(node);
  }
  for (const auto& [first, nodes] : nodes_of_part) {
    const RigidMotions<Dimension> motions(model, here, part, nodes);
    for (const auto& combination : motions.permitted(here.controls)) {
      const Vector motion = motions.columns() * combination;
      const double stiffness = spring_variation(model, here, motion);
      if (stiffness <= 0.0 || stiffness >= rounding * motion.squaredNorm()) continue;
      return fmt::format(
          "springs or foundations alone hold rod '{}' against {}, with {:.3g} N/m, which is lost "
          "in the rounding errors of its stiffness against stretching",
          place_of(model, first).rod, motions.in_words(combination), stiffness);
    }
  }
  return "";
}

}  // namespace

std::string find_weakly_held_part(const Model& model, const Configuration& here, double rounding) {
  return model.dimension == 2 ? find_weakly_held<2>(model, here, rounding)
                              : find_weakly_held<3>(model, here, rounding);
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
