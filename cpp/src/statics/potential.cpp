#include "der/statics/potential.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <type_traits>

#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/num_joints.hpp"
#include "der/energies/registry.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "energies/every_kind.hpp"

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
    evaluate_element<Kernel, Derivatives::Energy>(constants, from,
                                                  gather(list.dofs[e], from.coordinates), before);
    evaluate_element<Kernel, Derivatives::Energy>(constants, from, gather(list.dofs[e], to), after);
    double change = after.energy - before.energy;
    if constexpr (HasPeriod<Kernel>::value) {
      const double period = Kernel::period(constants, from);
      if (period > 0.0) change = std::remainder(change, period);
    }
    total += change;
  }
  return total;
}

template <class Kernel>
struct NumDofs : std::integral_constant<int, Kernel::kDofs> {};
constexpr int kMostDofs =
    std::apply([](auto... n) { return std::max({n...}); }, of_every_kind<NumDofs>());

template <class Kernel, class = void>
struct NumPositions : std::integral_constant<int, Kernel::kDofs> {};
/// In a plane the rotations of joints follow the nodes.
template <class Kernel>
struct NumPositions<
    Kernel, std::enable_if_t<(NumJoints<Kernel>::value > 0 && NumJoints<Kernel>::value < 3)>>
    : std::integral_constant<int, Kernel::kDofs - Kernel::kJoints> {};
/// In space angles of edges follow them, then joints.
template <class Kernel>
struct NumPositions<
    Kernel, std::enable_if_t<(NumJoints<Kernel>::value == 0 || NumJoints<Kernel>::value >= 3) &&
                             (Kernel::kDofs > 3 * Kernel::kNodes)>>
    : std::integral_constant<int, 3 * Kernel::kNodes> {};

/// The Hessian of an element of any kind. Its size is no part of the type, so that the functions
/// below are compiled once for all kinds.
struct ElementHessian {
  using Part = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostDofs, 1>;
  using Parts = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostDofs>;

  const Index* dofs = nullptr;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostDofs, kMostDofs> values;
  int components = 0;     ///< of a node, where a translation of the element costs no energy; else 0
  int num_positions = 0;  ///< coordinates of nodes; those of angles follow

  /// The element's part of a displacement, less that of its first node where a translation
  /// costs no energy.
  template <class Displacement>
  [[nodiscard]] Part relative(const Displacement& displacement) const {
    Part d(values.rows());
    for (Eigen::Index i = 0; i < d.size(); ++i) {
      d[i] = displacement[dofs[i]];
      if (components > 0 && i < num_positions) d[i] -= displacement[dofs[i % components]];
    }
    return d;
  }
};

/// Calls use(element) for each element.
template <class Use>
void for_each_hessian(const Model& model, const Configuration& here, const Use& use) {
  ElementHessian element;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    LocalTerm<Kernel::kDofs> local;
    element.components = HoldsElement<Kernel>::value ? 0 : model.dimension;
    element.num_positions = NumPositions<Kernel>::value;
    for (std::size_t e = 0; e < list.size(); ++e) {
      evaluate_element<Kernel, Derivatives::Hessian>(list.constants[e], here,
                                                     gather(list.dofs[e], here.coordinates), local);
      element.dofs = list.dofs[e].data();
      element.values = local.hessian.template selfadjointView<Eigen::Lower>();
      use(element);
    }
  });
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
  for_each_hessian(model, here, [&](const ElementHessian& element) {
    const auto d = element.relative(direction);
    total.value += d.dot(element.values.lazyProduct(d));
    total.terms += d.cwiseAbs().dot(element.values.cwiseAbs().lazyProduct(d.cwiseAbs()));
  });
  return total;
}

SecondVariations second_variations(const Model& model, const Configuration& here,
                                   const Eigen::MatrixXd& directions) {
  const Eigen::Index count = directions.cols();
  SecondVariations result{Eigen::MatrixXd::Zero(count, count), Vector::Zero(count)};
  ElementHessian::Parts d;
  ElementHessian::Parts products;
  for_each_hessian(model, here, [&](const ElementHessian& element) {
    d.resize(element.values.rows(), count);
    for (Eigen::Index i = 0; i < count; ++i) d.col(i) = element.relative(directions.col(i));
    products = element.values.lazyProduct(d);
    result.values += d.transpose().lazyProduct(products);
    products = element.values.cwiseAbs().lazyProduct(d.cwiseAbs());
    result.terms += d.cwiseAbs().cwiseProduct(products).colwise().sum().transpose();
  });
  return result;
}

Vector stiffness_product(const Model& model, const Configuration& here, const Vector& direction) {
  Vector product = Vector::Zero(direction.size());
  for_each_hessian(model, here, [&](const ElementHessian& element) {
    const ElementHessian::Part force = element.values.lazyProduct(element.relative(direction));
    for (Eigen::Index i = 0; i < force.size(); ++i) product[element.dofs[i]] += force[i];
  });
  return product;
}

namespace {

double largest_spatial_turning_angle(const Model& model, const Vector& positions) {
  double largest = 0.0;
  for (const RodMesh& rod : model.rods) {
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
