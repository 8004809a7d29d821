#pragma once

#include <cmath>

#include "der/core/types.hpp"
#include "der/kinematics/curvature_binormal.hpp"
#include "der/kinematics/joint_strain.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// Stiffnesses and rest shape of the joint between two neighbouring edges.
struct Joint {
  double bend_1 = 0.0;  ///< EI1 over the cell length [N m]
  double bend_2 = 0.0;  ///< EI2 over the cell length [N m]
  double twist = 0.0;   ///< GJ over the cell length [N m]
  JointStrain rest;     ///< of natural curvature and twist
};

/// Energy [J] of a joint and its derivatives with respect to the rotations omega_a, omega_b of its
/// two frames: dE = M . (omega_b - omega_a), and M changes by
///   dM = (S - 1/2 [M]x) omega_b - (S + 1/2 [M]x) omega_a.
/// Turning both frames turns M with them, which is why one symmetric matrix tells it all.
struct JointResponse {
  double energy = 0.0;
  Vec3 moment = Vec3::Zero();     ///< M [N m]
  Mat3 stiffness = Mat3::Zero();  ///< S [N m]
};

/// The joint as its two frames see it: kb = f ta x tb, read in the frame of edge a turned by half
/// of the twist, so that bending a rod of a round section does not depend on its twist however
/// large.
template <class Curvature>
class JointKinematics {
 public:
  /// `twist` is the whole twist [rad] between the two frames, whole turns included.
  JointKinematics(const SectionFrame& a, const SectionFrame& b, double twist)
      : ta_(a.tangent),
        tb_(b.tangent),
        cosine_(ta_.dot(tb_)),
        factor_(Binormal<Curvature>::of(cosine_)) {
    const SectionFrame middle = a.turned(0.5 * twist);
    m1_ = middle.first;
    m2_ = middle.second;
    strain_ = {factor_.f * m1_.dot(tb_), factor_.f * m2_.dot(tb_), twist};
  }

  [[nodiscard]] const JointStrain& strain() const { return strain_; }

  [[nodiscard]] double energy(const Joint& joint) const {
    const double k1 = strain_.kappa_1 - joint.rest.kappa_1;
    const double k2 = strain_.kappa_2 - joint.rest.kappa_2;
    const double k3 = strain_.twist - joint.rest.twist;
    return 0.5 * (joint.bend_1 * k1 * k1 + joint.bend_2 * k2 * k2 + joint.twist * k3 * k3);
  }

  /// Sets the energy and M, and S if `with_stiffness`.
  template <bool with_stiffness>
  void respond(const Joint& joint, JointResponse& out) const {
    const auto& [k1, k2, twist] = strain_;
    const double q1 = joint.bend_1 * (k1 - joint.rest.kappa_1);
    const double q2 = joint.bend_2 * (k2 - joint.rest.kappa_2);
    const double torque = joint.twist * (twist - joint.rest.twist);
    const double h = factor_.log_slope;
    const double half = 1.0 / (1.0 + cosine_);
    const Vec3 w = tb_.cross(ta_);       // gradient of the cosine by omega_b
    const Vec3 gt = half * (ta_ + tb_);  // of the twist
    const Vec3 g1 = h * k1 * w + factor_.f * tb_.cross(m1_) + 0.5 * k2 * gt;  // of kappa_1
    const Vec3 g2 = h * k2 * w + factor_.f * tb_.cross(m2_) - 0.5 * k1 * gt;  // of kappa_2
    const Vec3 bend = q1 * g1 + q2 * g2;
    out.energy = energy(joint);
    out.moment = bend + torque * gt;
    if constexpr (!with_stiffness) return;

    const double in_line = q1 * k1 + q2 * k2;
    const double across = q1 * k2 - q2 * k1;
    const Vec3 turned = q1 * g2 - q2 * g1;
    const Vec3 lean = h * in_line * ta_ + factor_.f * (q1 * m1_ + q2 * m2_);
    // Coefficients of w and of gt in symmetric products with them.
    const Vec3 with_w = h * bend + 0.5 * factor_.log_change * in_line * w -
                        (0.5 * half * torque + (0.5 * h + 0.25 * half) * across) * gt;
    const Vec3 with_gt = 0.5 * turned + 0.125 * in_line * gt;
    Mat3 half_sum = 0.5 * (joint.bend_1 * g1 * g1.transpose() + joint.bend_2 * g2 * g2.transpose() +
                           joint.twist * gt * gt.transpose()) +
                    w * with_w.transpose() + gt * with_gt.transpose() +
                    0.5 * tb_ * lean.transpose();
    half_sum.diagonal().array() -= 0.5 * in_line * (1.0 + h * cosine_);
    out.stiffness = half_sum + half_sum.transpose();
  }

 private:
  Vec3 ta_;
  Vec3 tb_;
  double cosine_;
  BinormalFactor factor_;
  Vec3 m1_;
  Vec3 m2_;
  JointStrain strain_;
};

}  // namespace der
