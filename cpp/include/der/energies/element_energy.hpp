#pragma once

#include <array>
#include <cstddef>

#include "der/core/types.hpp"
#include "der/energies/element_list.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// The entries of a field over all degrees of freedom that belong to one element's stencil.
template <class T = double, std::size_t N, class Field>
Eigen::Matrix<T, static_cast<int>(N), 1> gather(const std::array<Index, N>& dofs,
                                                const Field& field) {
  Eigen::Matrix<T, static_cast<int>(N), 1> local;
  for (std::size_t i = 0; i < N; ++i) local[static_cast<Index>(i)] = field[dofs[i]];
  return local;
}

/// `Kernel::evaluate<D>` of one element at its coordinates x. It is compiled for all kinds in
/// element_energy.cpp alone: a loop over all kinds that calls the kernels themselves takes the
/// compiler a minute. In assembly/, where calls count, the kernels are inlined.
template <class Kernel, Derivatives D>
void evaluate_element(const typename Kernel::Constants& constants, const Configuration& here,
                      const Eigen::Matrix<double, Kernel::kDofs, 1>& x,
                      LocalTerm<Kernel::kDofs>& out);

/// Energy [J] of all elements of one kind with the controls of a configuration, at other
/// coordinates (a vector, or Strided).
template <class Kernel, class Coordinates>
double element_energy(const ElementList<Kernel>& list, const Configuration& here,
                      const Coordinates& coordinates) {
  LocalTerm<Kernel::kDofs> local;
  double total = 0.0;
  for (std::size_t e = 0; e < list.size(); ++e) {
    evaluate_element<Kernel, Derivatives::Energy>(list.constants[e], here,
                                                  gather(list.dofs[e], coordinates), local);
    total += local.energy;
  }
  return total;
}

/// Energy [J] of all elements of one kind at a configuration.
template <class Kernel>
double element_energy(const ElementList<Kernel>& list, const Configuration& here) {
  return element_energy(list, here, here.coordinates);
}

}  // namespace der
