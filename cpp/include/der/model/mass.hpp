#pragma once

#include <vector>

#include "der/core/types.hpp"

namespace der {

/// Mass [kg] that couples two degrees of freedom.
struct MassCoupling {
  Index a = 0;
  Index b = 0;
  double mass = 0.0;
};

/// The mass matrix M = diag(lumped) - sum over couplings of mass (e_a - e_b)(e_a - e_b)^T, e the
/// unit vectors, over all degrees of freedom.
///
/// Each edge of mass m couples its nodes by m/6: together with m/2 lumped on both that is the
/// consistent mass of linear interpolation, a uniform rigid bar where lumped masses would be a
/// dumbbell with three times its rotary inertia. It brings the bending waves of the chain from
/// order 2 to order 4 in the edge length l: their squared frequency is EI k^4 (1 - (k l)^2/6 + ..),
/// k the wave number, over the mass per length, and that too is mu (1 - (k l)^2/6 + ..) with the
/// coupling, but mu without.
///
/// An edge that a support holds at one end stays lumped, which changes its energy by the order of
/// l^3: so the motion of a support never acts on its neighbours through the mass.
struct Mass {
  Vector lumped;
  std::vector<MassCoupling> coupling;

  /// M v [kg m/s].
  [[nodiscard]] Vector momentum(const Vector& velocities) const;
  /// 1/2 v^T M v [J].
  [[nodiscard]] double kinetic_energy(const Vector& velocities) const;
  /// A diagonal that M is nowhere below: v^T diag(bound) v <= v^T M v.
  [[nodiscard]] Vector lower_bound() const;
};

}  // namespace der
