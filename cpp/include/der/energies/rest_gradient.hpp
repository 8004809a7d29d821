#pragma once

#include "der/core/types.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/planar_clamp.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/stretch.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/kinematics/rest_shift.hpp"

namespace der {

/// Derivative of the energy of an element by what actuations add to its rest shape: the opposite of
/// its tension [N], or of its moments and torque [N m].
///
/// A kind of element that has a RestShift specialises it with
///   static constexpr int kSize;  // number of entries of the controls from the shift's on
///   static const RestShift& shift(const Constants&);
///   static Eigen::Matrix<double, kSize, 1> of(const Constants&, const Configuration& here, x);
template <class Kernel>
struct RestGradient {
  static constexpr bool kExists = false;
};

template <int Dim>
struct RestGradient<Stretch<Dim>> {
  using Kernel = Stretch<Dim>;
  static constexpr bool kExists = true;
  static constexpr int kSize = 1;
  static const RestShift& shift(const typename Kernel::Constants& c) { return c.elongation; }
  static Eigen::Matrix<double, kSize, 1> of(const typename Kernel::Constants& c,
                                            const Configuration& here,
                                            const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    const double length = Kernel::edge(x).norm();
    return Eigen::Matrix<double, kSize, 1>(-Kernel::response(c, here.controls, length).tension);
  }
};

template <class Curvature>
struct RestGradient<PlanarBend<Curvature>> {
  using Kernel = PlanarBend<Curvature>;
  static constexpr bool kExists = true;
  static constexpr int kSize = 1;
  static const RestShift& shift(const typename Kernel::Constants& c) { return c.actuated; }
  static Eigen::Matrix<double, kSize, 1> of(const typename Kernel::Constants& c,
                                            const Configuration& here,
                                            const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    const auto [before, after] = Kernel::edges(x);
    const double kappa = Curvature::of(angle_between(before, after)).kappa;
    return Eigen::Matrix<double, kSize, 1>(-c.stiffness_per_length *
                                           (kappa - c.natural(here.controls)));
  }
};

template <class Curvature>
struct RestGradient<PlanarClamp<Curvature>> {
  using Kernel = PlanarClamp<Curvature>;
  static constexpr bool kExists = true;
  static constexpr int kSize = 1;
  static const RestShift& shift(const typename Kernel::Constants& c) { return c.actuated; }
  static Eigen::Matrix<double, kSize, 1> of(const typename Kernel::Constants& c,
                                            const Configuration& here,
                                            const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    const Vec2 edge = x.template tail<2>() - x.template head<2>();
    const double kappa = Curvature::of(Kernel::turning_angle(c, here.controls, edge)).kappa;
    return Eigen::Matrix<double, kSize, 1>(-c.stiffness_per_length *
                                           (kappa - c.natural(here.controls)));
  }
};

template <class Curvature, class AJoint>
struct RestGradient<SpatialBend<Curvature, AJoint>> {
  using Kernel = SpatialBend<Curvature, AJoint>;
  static constexpr bool kExists = true;
  static constexpr int kSize = 3;
  static const RestShift& shift(const typename Kernel::Constants& c) { return c.actuated; }
  static Vec3 of(const typename Kernel::Constants& c, const Configuration& here,
                 const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    const auto [a, b, twist] = Kernel::frames(c, here.controls, x);
    const JointKinematics<Curvature> kinematics(a.frame, b.frame, twist);
    const auto [q1, q2, torque] = c.actuated_joint(here.controls).load(kinematics.strain());
    return {-q1, -q2, -torque};
  }
};

template <class Curvature>
struct RestGradient<SpatialClamp<Curvature>> {
  using Kernel = SpatialClamp<Curvature>;
  static constexpr bool kExists = true;
  static constexpr int kSize = 3;
  static const RestShift& shift(const typename Kernel::Constants& c) { return c.actuated; }
  static Vec3 of(const typename Kernel::Constants& c, const Configuration& here,
                 const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    const auto [edge, a, b, twist] = Kernel::frames(c, here.controls, x);
    const JointKinematics<Curvature> kinematics(a, b, twist);
    const auto [q1, q2, torque] = c.actuated_joint(here.controls).load(kinematics.strain());
    return {-q1, -q2, -torque};
  }
};

template <class Kernel, class PivotKind>
struct RestGradient<FromPivot<Kernel, PivotKind>> : RestGradient<Kernel> {
  using Element = RestGradient<Kernel>;
  using Constants = typename FromPivot<Kernel, PivotKind>::Constants;
  static const RestShift& shift(const Constants& c) { return Element::shift(c.element); }
  static auto of(const Constants& c, const Configuration& here,
                 const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    return Element::of(c.element, here,
                       FromPivot<Kernel, PivotKind>::from_pivots(c, here.controls, x));
  }
};

}  // namespace der
