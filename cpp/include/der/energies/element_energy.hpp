#pragma once

#include <array>
#include <cstddef>

#include "der/core/types.hpp"
#include "der/energies/element_list.hpp"
#include "der/energies/local_term.hpp"

namespace der {

/// The coordinates of one element's stencil.
template <std::size_t N>
Eigen::Matrix<double, static_cast<int>(N), 1> gather(const std::array<Index, N>& dofs,
                                                     const Vector& positions) {
  Eigen::Matrix<double, static_cast<int>(N), 1> local;
  for (std::size_t i = 0; i < N; ++i) local[static_cast<Index>(i)] = positions[dofs[i]];
  return local;
}

/// Energy [J] of all elements of one kind.
template <class Kernel>
double element_energy(const ElementList<Kernel>& list, const Vector& controls,
                      const Vector& positions) {
  LocalTerm<Kernel::kDofs> local;
  double total = 0.0;
  for (std::size_t e = 0; e < list.size(); ++e) {
    Kernel::template evaluate<Derivatives::Energy>(list.constants[e], controls,
                                                   gather(list.dofs[e], positions), local);
    total += local.energy;
  }
  return total;
}

}  // namespace der
