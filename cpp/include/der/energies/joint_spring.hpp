#pragma once

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A rotational spring in a plane, E = 1/2 k angle^2: on one joint, whose angle is its rotation
/// from the initial shape, or between the two sides of a hinge, whose angle is the rotation of the
/// second less that of the first. Rotations count whole turns, so the spring winds up without an
/// end. Between two sides there may be a damping, too (StrainRate), and it may be that alone.
template <int Joints>
struct JointSpring {
  static_assert(Joints == 1 || Joints == 2);
  static constexpr int kNodes = 0;
  static constexpr int kJoints = Joints;
  static constexpr int kDofs = Joints;
  static constexpr EnergyTerm kTerm = EnergyTerm::Spring;
  using Coordinates = Eigen::Matrix<double, kDofs, 1>;
  struct Constants {
    double stiffness = 0.0;  ///< [N m/rad]
  };
  /// The derivatives of the angle by the rotations.
  static Coordinates gradient() {
    Coordinates result;
    result[0] = Joints == 1 ? 1.0 : -1.0;
    result[Joints - 1] = 1.0;
    return result;
  }
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& /*here*/, const Coordinates& x,
                       LocalTerm<kDofs>& out) {
    const Coordinates by_rotations = gradient();
    const double angle = by_rotations.dot(x);
    out.energy = 0.5 * c.stiffness * angle * angle;
    out.gradient = c.stiffness * angle * by_rotations;
    out.hessian = c.stiffness * by_rotations * by_rotations.transpose();
  }
};

}  // namespace der
