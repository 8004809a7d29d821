#pragma once

#include <cmath>

#include "der/core/types.hpp"
#include "der/kinematics/curvature_binormal.hpp"
#include "der/kinematics/joint_strain.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// Stiffnesses and rest shape of the joint between two neighbouring edges.
template <class T>
struct JointOf {
  T bend_1 = 0.0;         ///< EI1 over the cell length [N m]
  T bend_2 = 0.0;         ///< EI2 over the cell length [N m]
  T twist = 0.0;          ///< GJ over the cell length [N m]
  JointStrainOf<T> rest;  ///< of natural curvature and twist
};
using Joint = JointOf<double>;

/// Energy [J] of a joint and its derivatives with respect to the rotations omega_a, omega_b of its
/// two frames: dE = M . (omega_b - omega_a), and M changes by
///   dM = (S - 1/2 [M]x) omega_b - (S + 1/2 [M]x) omega_a.
/// Turning both frames turns M with them, which is why one symmetric matrix tells it all.
template <class T>
struct JointResponseOf {
  T energy = 0.0;
  Vector3<T> moment = Vector3<T>::Zero();     ///< M [N m]
  Matrix3<T> stiffness = Matrix3<T>::Zero();  ///< S [N m]
};
using JointResponse = JointResponseOf<double>;

/// The joint as its two frames see it: kb = f ta x tb, read in the frame of edge a turned by half
/// of the twist, so that bending a rod of a round section does not depend on its twist however
/// large.
template <class Curvature, class T = double>
class JointKinematics {
 public:
  /// `twist` is the whole twist [rad] between the two frames, whole turns included.
  JointKinematics(const SectionFrameOf<T>& a, const SectionFrameOf<T>& b, const T& twist)
      : ta_(a.tangent),
        tb_(b.tangent),
        cosine_(ta_.dot(tb_)),
        factor_(Binormal<Curvature>::of(cosine_)) {
    const SectionFrameOf<T> middle = a.turned(0.5 * twist);
    m1_ = middle.first;
    m2_ = middle.second;
    strain_ = {factor_.f * m1_.dot(tb_), factor_.f * m2_.dot(tb_), twist};
  }

  [[nodiscard]] const JointStrainOf<T>& strain() const { return strain_; }

  [[nodiscard]] T energy(const JointOf<T>& joint) const {
    const T k1 = strain_.kappa_1 - joint.rest.kappa_1;
    const T k2 = strain_.kappa_2 - joint.rest.kappa_2;
    const T k3 = strain_.twist - joint.rest.twist;
    return 0.5 * (joint.bend_1 * k1 * k1 + joint.bend_2 * k2 * k2 + joint.twist * k3 * k3);
  }

  /// Sets the energy and M, and S if `with_stiffness`.
  template <bool with_stiffness>
  void respond(const JointOf<T>& joint, JointResponseOf<T>& out) const {
    const auto& [k1, k2, twist] = strain_;
    const T q1 = joint.bend_1 * (k1 - joint.rest.kappa_1);
    const T q2 = joint.bend_2 * (k2 - joint.rest.kappa_2);
    const T torque = joint.twist * (twist - joint.rest.twist);
    const T h = factor_.log_slope;
    const T half = 1.0 / (1.0 + cosine_);
    const Vector3<T> w = tb_.cross(ta_);       // gradient of the cosine by omega_b
    const Vector3<T> gt = half * (ta_ + tb_);  // of the twist
    const Vector3<T> g1 = h * k1 * w + factor_.f * tb_.cross(m1_) + 0.5 * k2 * gt;  // of kappa_1
    const Vector3<T> g2 = h * k2 * w + factor_.f * tb_.cross(m2_) - 0.5 * k1 * gt;  // of kappa_2
    const Vector3<T> bend = q1 * g1 + q2 * g2;
    out.energy = energy(joint);
    out.moment = bend + torque * gt;
    if constexpr (!with_stiffness) return;

    const T in_line = q1 * k1 + q2 * k2;
    const T across = q1 * k2 - q2 * k1;
    const Vector3<T> turned = q1 * g2 - q2 * g1;
    const Vector3<T> lean = h * in_line * ta_ + factor_.f * (q1 * m1_ + q2 * m2_);
    // Coefficients of w and of gt in symmetric products with them.
    const Vector3<T> with_w = h * bend + 0.5 * factor_.log_change * in_line * w -
                              (0.5 * half * torque + (0.5 * h + 0.25 * half) * across) * gt;
    const Vector3<T> with_gt = 0.5 * turned + 0.125 * in_line * gt;
    Matrix3<T> half_sum =
        0.5 * (joint.bend_1 * g1 * g1.transpose() + joint.bend_2 * g2 * g2.transpose() +
               joint.twist * gt * gt.transpose()) +
        w * with_w.transpose() + gt * with_gt.transpose() + 0.5 * tb_ * lean.transpose();
    half_sum.diagonal().array() -= 0.5 * in_line * (1.0 + h * cosine_);
    out.stiffness = half_sum + half_sum.transpose();
  }

 private:
  Vector3<T> ta_;
  Vector3<T> tb_;
  T cosine_;
  BinormalFactor<T> factor_;
  Vector3<T> m1_;
  Vector3<T> m2_;
  JointStrainOf<T> strain_;
};

}  // namespace der
