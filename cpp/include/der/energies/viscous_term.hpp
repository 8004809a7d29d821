#pragma once

#include "der/core/types.hpp"
#include "der/energies/element_list.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A configuration with its velocities, one a degree of freedom [m/s], and the rates of the
/// controls that turn clamps, one a control [1/s]; no rates: no clamp turns.
struct Moving {
  const Configuration& here;
  const Vector& velocities;
  const Vector& turn_rates;
};

/// The forces on the coordinates of an element with internal damping, B' V s' with the rates of its
/// strains s' (StrainRate), and the power [W] of what turns its clamps against them.
template <class Kernel>
struct ViscousTerm {
  Eigen::Matrix<double, Kernel::kDofs, 1> gradient;  ///< [N]
  double driven = 0.0;
};

// Both are compiled in viscous_term.cpp, for the kinds of elements with a StrainRate.

template <class Kernel>
ViscousTerm<Kernel> viscous_term(const ElementList<Kernel>& list, const DampedElement& damped,
                                 const Moving& moving);

/// The derivative [N s/m] of these forces by the velocities, B' V B.
template <class Kernel>
Eigen::Matrix<double, Kernel::kDofs, Kernel::kDofs> viscous_matrix(const ElementList<Kernel>& list,
                                                                   const DampedElement& damped,
                                                                   const Configuration& here);

}  // namespace der
