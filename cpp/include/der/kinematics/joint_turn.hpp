#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "der/core/types.hpp"
#include "der/kinematics/cross_matrix.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// The values that the state follows for one joint in space, as entries of the controls that
/// elements see: its rotation coordinates at the start of the step, and its rotation there, a unit
/// quaternion (w, x, y, z). The blocks of all joints stand behind those of the edges' frames.
struct JointBlock {
  static constexpr Index kSize = 7;
  Index first = -1;  ///< entry of the controls

  template <class Values>
  [[nodiscard]] Vec3 coordinates(const Values& values) const {
    return values.template segment<3>(first);
  }
  template <class Values>
  [[nodiscard]] Eigen::Quaterniond rotation(const Values& values) const {
    return {values[first + 3], values[first + 4], values[first + 5], values[first + 6]};
  }
};

/// The section of a leg at a joint, which turns with the joint.
struct JointSection {
  SectionFrame drawn;
  JointBlock joint;
};

/// The rotation that the vector `delta` stands for.
inline Eigen::Quaterniond rotation_by(const Vec3& delta) {
  const double angle = delta.norm();
  const double half = 0.5 * angle;
  const double share = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  Eigen::Quaterniond turn;
  turn.w() = std::cos(half);
  turn.vec() = share * delta;
  return turn;
}

/// The vector of a rotation [rad], of up to half a turn.
inline Vec3 rotation_vector(const Eigen::Quaterniond& turn) {
  const double sign = turn.w() < 0.0 ? -1.0 : 1.0;
  const double sine = turn.vec().norm();
  if (sine == 0.0) return Vec3::Zero();
  return sign * 2.0 * std::atan2(sine, sign * turn.w()) / sine * turn.vec();
}

/// The rotation of a joint in space as a function of its three coordinates w: R = exp([d]x) R0 with
/// d = w - w0, where w0 and R0 belong to the start of the step (JointBlock). So the coordinates
/// have no singular place as long as a step turns by less than a whole turn.
///
/// A change of w turns the joint by omega = T dw with T = 1 + a [d]x + b [d]x^2,
/// a = (1 - cos |d|)/|d|^2 and b = (|d| - sin |d|)/|d|^3.
class JointTurn {
 public:
  template <class Values>
  JointTurn(const JointBlock& block, const Values& controls, const Vec3& w)
      : JointTurn(w - block.coordinates(controls), block.rotation(controls)) {}
  JointTurn(const Vec3& delta, const Eigen::Quaterniond& base)
      : delta_(delta), rotation_((rotation_by(delta) * base).toRotationMatrix()) {
    const double x = delta.squaredNorm();
    if (x < 1.0) {
      set_series(x);
      return;
    }
    const double angle = std::sqrt(x);
    const double sine = std::sin(angle);
    const double cosine = std::cos(angle);
    a_ = (1.0 - cosine) / x;
    b_ = (angle - sine) / (x * angle);
    a_slope_ = (angle * sine - 2.0 * (1.0 - cosine)) / (x * x);
    b_slope_ = (3.0 * sine - 2.0 * angle - angle * cosine) / (x * x * angle);
  }

  /// From the start of the step [rad].
  [[nodiscard]] const Vec3& delta() const { return delta_; }
  /// R, from the initial shape.
  [[nodiscard]] const Mat3& rotation() const { return rotation_; }
  /// A section that turns with the joint.
  [[nodiscard]] SectionFrame section(const SectionFrame& drawn) const {
    return SectionFrame::of(rotation_ * drawn.tangent, rotation_ * drawn.first);
  }
  /// T.
  [[nodiscard]] Mat3 spin() const {
    const Mat3 cross = cross_matrix<double>(delta_);
    return Mat3::Identity() + a_ * cross + b_ * cross * cross;
  }
  /// Derivative by w of the generalised forces T' N of a moment N [N m] that stays as it is.
  [[nodiscard]] Mat3 force_gradient(const Vec3& moment) const {
    const Vec3 across = delta_.cross(moment);
    Mat3 result = a_ * cross_matrix<double>(moment);
    result -= a_slope_ * across * delta_.transpose();
    result += b_slope_ * delta_.cross(across) * delta_.transpose();
    result += b_ * (delta_ * moment.transpose() - 2.0 * moment * delta_.transpose());
    result.diagonal().array() += b_ * delta_.dot(moment);
    return result;
  }
  /// The symmetric part of this: the Hessian of an energy E with dE = N . omega and
  /// dN = (S - 1/2 [N]x) omega is T' S T + this.
  [[nodiscard]] Mat3 geometric_stiffness(const Vec3& moment) const {
    const Mat3 gradient = force_gradient(moment);
    return 0.5 * (gradient + gradient.transpose());
  }

 private:
  /// The power series of a, b and of twice their derivatives by x = |d|^2.
  void set_series(double x) {
    constexpr int kTerms = 9;
    a_ = b_ = a_slope_ = b_slope_ = 0.0;
    double per_factorial = 0.5;  // (-1)^k/(2 k + 2)!
    double power = 1.0;          // x^k
    double lower = 0.0;          // x^(k - 1)
    for (int k = 0; k < kTerms; ++k) {
      const double next = per_factorial / (2 * k + 3);
      a_ += per_factorial * power;
      b_ += next * power;
      a_slope_ += 2.0 * k * per_factorial * lower;
      b_slope_ += 2.0 * k * next * lower;
      lower = power;
      power *= x;
      per_factorial = -next / (2 * k + 4);
    }
  }

  Vec3 delta_;
  Mat3 rotation_;
  double a_ = 0.5;
  double b_ = 1.0 / 6.0;
  double a_slope_ = 0.0;  // (da/d|d|)/|d|
  double b_slope_ = 0.0;
};

}  // namespace der
