#include "der/energies/viscous_term.hpp"

#include <tuple>

#include "der/energies/element_energy.hpp"
#include "der/energies/strain_rate.hpp"
#include "energies/every_kind.hpp"

namespace der {

template <class Kernel>
ViscousTerm<Kernel> viscous_term(const ElementList<Kernel>& list, const DampedElement& damped,
                                 const Moving& moving) {
  using Strain = StrainRate<Kernel>;
  constexpr int n = Strain::kSize;
  const auto& dofs = list.dofs[damped.element];
  const auto& constants = list.constants[damped.element];
  const auto x = gather(dofs, moving.here.coordinates);
  const typename Strain::Gradient gradient = Strain::gradient(constants, moving.here, x);
  typename Strain::Rates rates = gradient * gather(dofs, moving.velocities);
  typename Strain::Rates driven = Strain::Rates::Zero();
  if (moving.turn_rates.size() > 0) {
    driven = Strain::driven(constants, moving.here, x, gradient, moving.turn_rates);
    rates += driven;
  }
  const typename Strain::Rates loads = damped.viscosity.template topLeftCorner<n, n>() * rates;
  return {gradient.transpose() * loads, driven.dot(loads)};
}

template <class Kernel>
Eigen::Matrix<double, Kernel::kDofs, Kernel::kDofs> viscous_matrix(const ElementList<Kernel>& list,
                                                                   const DampedElement& damped,
                                                                   const Configuration& here) {
  using Strain = StrainRate<Kernel>;
  constexpr int n = Strain::kSize;
  const auto x = gather(list.dofs[damped.element], here.coordinates);
  const typename Strain::Gradient gradient =
      Strain::gradient(list.constants[damped.element], here, x);
  return gradient.transpose() * damped.viscosity.template topLeftCorner<n, n>() * gradient;
}

namespace {

template <class Kernel>
constexpr auto viscous_functions() {
  if constexpr (StrainRate<Kernel>::kExists) {
    return std::tuple{&viscous_term<Kernel>, &viscous_matrix<Kernel>};
  } else {
    return std::tuple{};
  }
}
template <class Kernel>
struct ViscousFunctions {
  static constexpr auto value = viscous_functions<Kernel>();
};

[[gnu::used]] constexpr auto kViscousFunctions = of_every_kind<ViscousFunctions>();

}  // namespace
}  // namespace der
