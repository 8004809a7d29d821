#pragma once

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A rotational spring on a joint in a plane: E = 1/2 k theta^2, theta the rotation of the joint
/// from the initial shape. Joints count whole turns, so the spring winds up without an end.
struct JointSpring {
  static constexpr int kNodes = 0;
  static constexpr int kJoints = 1;
  static constexpr int kDofs = 1;
  static constexpr EnergyTerm kTerm = EnergyTerm::Spring;
  struct Constants {
    double stiffness = 0.0;  ///< [N m/rad]
  };
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& /*here*/,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    out.energy = 0.5 * c.stiffness * x[0] * x[0];
    out.gradient[0] = c.stiffness * x[0];
    out.hessian(0, 0) = c.stiffness;
  }
};

}  // namespace der
