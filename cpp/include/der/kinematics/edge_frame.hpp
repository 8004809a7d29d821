#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// Spin a [1/m] about the tangent, by a change of the vector of an edge, of a frame that is
/// transported from the unit tangent `source` (EdgeFrame).
inline Vec3 transport_spin(const Vec3& edge, const Vec3& source) {
  const double length = edge.norm();
  return -source.cross(edge) / (length * (length + source.dot(edge)));
}

/// The section frame on an edge as a function of the edge vector e and the angle theta: the
/// reference director of the edge's source, transported from the source's tangent to that of e in
/// one step, then turned by theta (Bergou et al., Discrete Viscous Threads, SIGGRAPH 2010,
/// section 4.2; Panetta et al., X-Shells, SIGGRAPH 2019).
///
/// A change of (e, theta) turns the frame by omega = (t x de)/|e| + (dtheta + a . de) t with the
/// spin a = -(s x t)/(|e| (1 + s . t)) of the transport from the source tangent s: it is zero
/// at the source only.
struct EdgeFrame {
  SectionFrame frame;
  double length = 1.0;          ///< [m]
  Vec3 source = Vec3::UnitX();  ///< source tangent
  Vec3 spin = Vec3::Zero();     ///< a [1/m]

  /// `director` is the reference director at the unit tangent `source`.
  EdgeFrame(const Vec3& edge, double theta, const Vec3& source_tangent, const Vec3& director)
      : length(edge.norm()), source(source_tangent) {
    const Vec3 tangent = edge / length;
    frame = SectionFrame::of(tangent, transport(director, source, tangent)).turned(theta);
    spin = transport_spin(edge, source);
  }

  /// omega = L (de, dtheta).
  [[nodiscard]] Eigen::Matrix<double, 3, 4> rotation() const {
    const Vec3& t = frame.tangent;
    Eigen::Matrix<double, 3, 4> result;
    for (int c = 0; c < 3; ++c) result.col(c) = t.cross(Vec3::Unit(c)) / length + spin[c] * t;
    result.col(3) = t;
    return result;
  }

  /// Derivative by (e, theta) of the generalised forces L' N of a moment N [N m] that stays as it
  /// is, with the part of the turning of N that makes it symmetric: the Hessian of an energy E
  /// with dE = N . omega and dN = (S - 1/2 [N]x) omega is L' S L + this.
  [[nodiscard]] Eigen::Matrix4d geometric_stiffness(const Vec3& moment) const {
    const Vec3& t = frame.tangent;
    const double torque = moment.dot(t);
    const Vec3 across = moment - torque * t;
    const Vec3 force = moment.cross(t) / (length * length);
    const Vec3 leaning = (source + (2.0 + source.dot(t)) * t) / (1.0 + source.dot(t));
    const auto sum_with_transposed = [](const Vec3& a, const Vec3& b) -> Mat3 {
      return a * b.transpose() + b * a.transpose();
    };
    Eigen::Matrix4d result = Eigen::Matrix4d::Zero();
    result.topLeftCorner<3, 3>() = -sum_with_transposed(force, t) +
                                   0.5 / length * sum_with_transposed(spin, across) -
                                   0.5 * torque / length * sum_with_transposed(spin, leaning);
    result.topRightCorner<3, 1>() = 0.5 / length * across;
    result.bottomLeftCorner<1, 3>() = result.topRightCorner<3, 1>().transpose();
    return result;
  }
};

}  // namespace der
