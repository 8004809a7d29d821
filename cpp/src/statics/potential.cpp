#include "der/statics/potential.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/registry.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {
namespace {

template <class Kernel, class = void>
struct HasPeriod : std::false_type {};
template <class Kernel>
struct HasPeriod<Kernel, std::void_t<decltype(&Kernel::period)>> : std::true_type {};

template <class Kernel>
double energy_change(const ElementList<Kernel>& list, const Configuration& from, const Vector& to) {
  LocalTerm<Kernel::kDofs> before;
  LocalTerm<Kernel::kDofs> after;
  double total = 0.0;
  for (std::size_t e = 0; e < list.size(); ++e) {
    const auto& constants = list.constants[e];
    Kernel::template evaluate<Derivatives::Energy>(constants, from,
                                                   gather(list.dofs[e], from.coordinates), before);
    Kernel::template evaluate<Derivatives::Energy>(constants, from, gather(list.dofs[e], to),
                                                   after);
    double change = after.energy - before.energy;
    if constexpr (HasPeriod<Kernel>::value) {
      const double period = Kernel::period(constants, from);
      if (period > 0.0) change = std::remainder(change, period);
    }
    total += change;
  }
  return total;
}

/// The displacement that may be taken from all nodes of an element at no cost of energy: that of
/// its first node. The coordinates of the element are those of nodes, then angles.
struct Shared {
  int components = 0;  ///< of a node; 0: none may
  int positions = 0;   ///< number of coordinates of nodes
};

template <class Kernel, class = void>
struct NumPositions : std::integral_constant<int, Kernel::kDofs> {};
template <class Kernel>
struct NumPositions<Kernel, std::enable_if_t<(Kernel::kDofs > 3 * Kernel::kNodes)>>
    : std::integral_constant<int, 3 * Kernel::kNodes> {};

/// Calls use(dofs, hessian, shared) for each element.
template <class Use>
void for_each_hessian(const Model& model, const Configuration& here, const Use& use) {
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    constexpr int kDofs = Kernel::kDofs;
    LocalTerm<kDofs> local;
    for (std::size_t e = 0; e < list.size(); ++e) {
      Kernel::template evaluate<Derivatives::Hessian>(
          list.constants[e], here, gather(list.dofs[e], here.coordinates), local);
      const Eigen::Matrix<double, kDofs, kDofs> hessian =
          local.hessian.template selfadjointView<Eigen::Lower>();
      use(list.dofs[e], hessian,
          Shared{HoldsElement<Kernel>::value ? 0 : model.dimension, NumPositions<Kernel>::value});
    }
  });
}

/// An element's part of a displacement, less what its nodes share.
template <std::size_t N, class Displacement>
Eigen::Matrix<double, static_cast<int>(N), 1> relative(const std::array<Index, N>& dofs,
                                                       const Displacement& displacement,
                                                       const Shared& shared) {
  Eigen::Matrix<double, static_cast<int>(N), 1> d;
  for (std::size_t i = 0; i < N; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    d[k] = displacement[dofs[i]];
    if (shared.components > 0 && k < shared.positions) {
      d[k] -= displacement[dofs[i % static_cast<std::size_t>(shared.components)]];
    }
  }
  return d;
}

}  // namespace

double potential_change(const Model& model, const Vector& force, const Configuration& from,
                        const Vector& to) {
  double total = -force.dot(to - from.coordinates);
  for_each_list(*model.elements, [&](const auto& list) { total += energy_change(list, from, to); });
  return total;
}

double second_variation(const Model& model, const Configuration& here, const Vector& direction) {
  return summed_variation(model, here, direction).value;
}

SummedVariation summed_variation(const Model& model, const Configuration& here,
                                 const Vector& direction) {
  SummedVariation total;
  for_each_hessian(model, here, [&](const auto& dofs, const auto& hessian, const Shared& shared) {
    const auto d = relative(dofs, direction, shared);
    total.value += d.dot(hessian * d);
    total.terms += d.cwiseAbs().dot(hessian.cwiseAbs() * d.cwiseAbs());
  });
  return total;
}

SecondVariations second_variations(const Model& model, const Configuration& here,
                                   const Eigen::MatrixXd& directions) {
  const Eigen::Index count = directions.cols();
  SecondVariations result{Eigen::MatrixXd::Zero(count, count), Vector::Zero(count)};
  for_each_hessian(model, here, [&](const auto& dofs, const auto& hessian, const Shared& shared) {
    constexpr int kDofs = std::decay_t<decltype(hessian)>::RowsAtCompileTime;
    Eigen::Matrix<double, kDofs, Eigen::Dynamic> d(kDofs, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      d.col(i) = relative(dofs, directions.col(i), shared);
    }
    result.values.noalias() += d.transpose() * (hessian * d).eval();
    const auto terms = d.cwiseAbs().cwiseProduct(hessian.cwiseAbs() * d.cwiseAbs()).eval();
    result.terms += terms.colwise().sum().transpose();
  });
  return result;
}

Vector stiffness_product(const Model& model, const Configuration& here, const Vector& direction) {
  Vector product = Vector::Zero(direction.size());
  for_each_hessian(model, here, [&](const auto& dofs, const auto& hessian, const Shared& shared) {
    const auto force = (hessian * relative(dofs, direction, shared)).eval();
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      product[dofs[i]] += force[static_cast<Eigen::Index>(i)];
    }
  });
  return product;
}

namespace {

double largest_spatial_turning_angle(const Model& model, const Vector& positions) {
  double largest = 0.0;
  for (const RodLayout& rod : model.rods) {
    for (Index place = 0; place < static_cast<Index>(rod.nodes.size()); ++place) {
      if (!rod.is_inner(place)) continue;
      const Vec3 before = along_edge<3>(rod.edge(rod.edge_before(place), model), positions);
      const Vec3 after = along_edge<3>(rod.edge(place, model), positions);
      largest = std::max(largest, std::atan2(before.cross(after).norm(), before.dot(after)));
    }
  }
  return largest;
}

}  // namespace

double largest_turning_angle(const Model& model, const Vector& positions) {
  double largest = 0.0;
  const auto look = [&](const auto& bends) {
    for (const auto& dofs : bends.dofs) {
      const auto [before, after] = PlanarBend<AngleCurvature>::edges(gather(dofs, positions));
      largest = std::max(largest, std::abs(angle_between(before, after)));
    }
  };
  look(elements_of<PlanarBend<AngleCurvature>>(*model.elements));
  look(elements_of<PlanarBend<TangentCurvature>>(*model.elements));
  if (model.dimension == 3) largest = largest_spatial_turning_angle(model, positions);
  return largest;
}

}  // namespace der
