#pragma once

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A rotational spring between the two sides of a hinge in a plane: E = 1/2 k (theta_2 - theta_1)^2
/// of their rotations from the initial shape. It winds up without an end. It may have a damping,
/// too (StrainRate), and may be that alone.
struct HingeSpring {
  static constexpr int kNodes = 0;
  static constexpr int kJoints = 2;
  static constexpr int kDofs = 2;
  static constexpr EnergyTerm kTerm = EnergyTerm::Spring;
  struct Constants {
    double stiffness = 0.0;  ///< [N m/rad]
  };
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& /*here*/,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    const double angle = x[1] - x[0];
    out.energy = 0.5 * c.stiffness * angle * angle;
    out.gradient << -c.stiffness * angle, c.stiffness * angle;
    out.hessian << c.stiffness, -c.stiffness, -c.stiffness, c.stiffness;
  }
};

}  // namespace der
