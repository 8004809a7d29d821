#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// Spin a [1/m] about the tangent, by a change of the vector of an edge, of a frame that is
/// transported from the unit tangent `source` to the unit tangent `tangent` (EdgeFrame).
template <class T>
Vector3<T> transport_spin(const Vector3<T>& tangent, const T& per_length,
                          const Vector3<T>& source) {
  return (-per_length / (1.0 + source.dot(tangent))) * source.cross(tangent);
}

template <class T>
Vector3<T> transport_spin(const Vector3<T>& edge, const Vector3<T>& source) {
  const T per_length = 1.0 / edge.norm();
  return transport_spin<T>(per_length * edge, per_length, source);
}

/// The section frame on an edge as a function of the edge vector e and the angle theta: the
/// reference director of the edge's source, transported from the source's tangent to that of e in
/// one step, then turned by theta (Bergou et al., Discrete Viscous Threads, SIGGRAPH 2010,
/// section 4.2; Panetta et al., X-Shells, SIGGRAPH 2019).
///
/// A change of (e, theta) turns the frame by omega = (t x de)/|e| + (dtheta + a . de) t with the
/// spin a = -(s x t)/(|e| (1 + s . t)) of the transport from the source tangent s: it is zero
/// at the source only.
template <class T>
struct EdgeFrameOf {
  using Variables = Eigen::Matrix<T, 4, 1>;
  using Block = Eigen::Matrix<T, 4, 4>;
  /// Not aligned: sums over its columns of three then have the same order in every number type.
  using Rotation = Eigen::Matrix<T, 3, 4, Eigen::DontAlign>;

  SectionFrameOf<T> frame;
  T length = 1.0;                           ///< [m]
  T per_length = 1.0;                       ///< 1/|e| [1/m]
  Vector3<T> source = Vector3<T>::UnitX();  ///< source tangent
  Vector3<T> spin = Vector3<T>::Zero();     ///< a [1/m]

  /// `director` is the reference director at the unit tangent `source`.
  EdgeFrameOf(const Vector3<T>& edge, const T& theta, const Vector3<T>& source_tangent,
              const Vector3<T>& director)
      : length(edge.norm()), per_length(1.0 / length), source(source_tangent) {
    const Vector3<T> tangent = per_length * edge;
    frame = SectionFrameOf<T>::of(tangent, transport<T>(director, source, tangent)).turned(theta);
    spin = transport_spin(tangent, per_length, source);
  }

  /// omega = L (de, dtheta).
  [[nodiscard]] Rotation rotation() const {
    const Vector3<T>& t = frame.tangent;
    const Vector3<T> across = per_length * t;
    Rotation result;
    result.col(0) << spin[0] * t[0], spin[0] * t[1] + across[2], spin[0] * t[2] - across[1];
    result.col(1) << spin[1] * t[0] - across[2], spin[1] * t[1], spin[1] * t[2] + across[0];
    result.col(2) << spin[2] * t[0] + across[1], spin[2] * t[1] - across[0], spin[2] * t[2];
    result.col(3) = t;
    return result;
  }

  /// Derivative by (e, theta) of the generalised forces L' N of a moment N [N m] that stays as it
  /// is, with the part of the turning of N that makes it symmetric: the Hessian of an energy E
  /// with dE = N . omega and dN = (S - 1/2 [N]x) omega is L' S L + this.
  [[nodiscard]] Block geometric_stiffness(const Vector3<T>& moment) const {
    const Vector3<T>& t = frame.tangent;
    const T torque = moment.dot(t);
    const Vector3<T> across = moment - torque * t;
    const Vector3<T> force = (per_length * per_length) * moment.cross(t);
    const T lean = 1.0 / (1.0 + source.dot(t));
    const Vector3<T> leaning = lean * source + (1.0 + lean) * t;
    // -(force t') + spin (across - torque leaning)'/(2 |e|), with its transpose.
    const Vector3<T> with_spin = (0.5 * per_length) * (across - torque * leaning);
    Matrix3<T> half = -force * t.transpose();
    half += spin * with_spin.transpose();
    Block result;
    result.template topLeftCorner<3, 3>() = half + half.transpose();
    result.template topRightCorner<3, 1>() = (0.5 * per_length) * across;
    result.template bottomLeftCorner<1, 3>() = result.template topRightCorner<3, 1>().transpose();
    result(3, 3) = 0.0;
    return result;
  }
};
using EdgeFrame = EdgeFrameOf<double>;

}  // namespace der
