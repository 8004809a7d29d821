#include "der/statics/potential.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "der/assembly/element_energy.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {
namespace {

template <class Kernel, class = void>
struct HasPeriod : std::false_type {};
template <class Kernel>
struct HasPeriod<Kernel, std::void_t<decltype(&Kernel::period)>> : std::true_type {};

template <class Kernel>
double energy_change(const ElementList<Kernel>& list, const Vector& controls, const Vector& from,
                     const Vector& to) {
  LocalTerm<Kernel::kDofs> before;
  LocalTerm<Kernel::kDofs> after;
  double total = 0.0;
  for (std::size_t e = 0; e < list.size(); ++e) {
    const auto& constants = list.constants[e];
    Kernel::template evaluate<Derivatives::Energy>(constants, controls, gather(list.dofs[e], from),
                                                   before);
    Kernel::template evaluate<Derivatives::Energy>(constants, controls, gather(list.dofs[e], to),
                                                   after);
    double change = after.energy - before.energy;
    if constexpr (HasPeriod<Kernel>::value) {
      const double period = Kernel::period(constants, controls);
      if (period > 0.0) change = std::remainder(change, period);
    }
    total += change;
  }
  return total;
}

}  // namespace

double potential_change(const Model& model, const Vector& controls, const Vector& force,
                        const Vector& from, const Vector& to) {
  double total = -force.dot(to - from);
  for_each_list(model.elements,
                [&](const auto& list) { total += energy_change(list, controls, from, to); });
  return total;
}

double second_variation(const Model& model, const Vector& controls, const Vector& positions,
                        const Vector& direction) {
  return summed_variation(model, controls, positions, direction).value;
}

SummedVariation summed_variation(const Model& model, const Vector& controls,
                                 const Vector& positions, const Vector& direction) {
  SummedVariation total;
  for_each_list(model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    LocalTerm<Kernel::kDofs> local;
    for (std::size_t e = 0; e < list.size(); ++e) {
      Kernel::template evaluate<Derivatives::Hessian>(list.constants[e], controls,
                                                      gather(list.dofs[e], positions), local);
      auto d = gather(list.dofs[e], direction);
      if constexpr (!HoldsElement<Kernel>::value) {
        for (Eigen::Index i = d.size() - 1; i >= 0; --i) d[i] -= d[i % model.dimension];
      }
      const auto size = d.cwiseAbs().eval();
      total.value += d.dot(local.hessian.template selfadjointView<Eigen::Lower>() * d);
      local.hessian = local.hessian.cwiseAbs().eval();
      total.terms += size.dot(local.hessian.template selfadjointView<Eigen::Lower>() * size);
    }
  });
  return total;
}

double largest_edge_change(const Model& model, const Vector& displacement) {
  double largest = 0.0;  // squared
  for (const Edge& edge : model.edges) {
    const auto d = gather(edge.dofs, displacement);
    const double length = edge.rest_length;
    largest = std::max(largest, (d.tail<2>() - d.head<2>()).squaredNorm() / (length * length));
  }
  return std::sqrt(largest);
}

double sharpest_turn(const Model& model, const Vector& positions) {
  double largest = 0.0;
  const auto look = [&](const auto& bends) {
    for (const auto& dofs : bends.dofs) {
      const auto x = gather(dofs, positions);
      const Vec2 before = x.template segment<2>(2) - x.template segment<2>(0);
      const Vec2 after = x.template segment<2>(4) - x.template segment<2>(2);
      largest = std::max(largest, std::abs(angle_between(before, after)));
    }
  };
  look(std::get<ElementList<PlanarBend<AngleCurvature>>>(model.elements));
  look(std::get<ElementList<PlanarBend<TangentCurvature>>>(model.elements));
  return largest;
}

}  // namespace der
