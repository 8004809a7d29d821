#pragma once

#include <cmath>

#include "der/core/constants.hpp"
#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {

/// A moment about z on an edge: the potential -M theta of the edge's direction angle theta, hence a
/// couple of forces M/|e| across the edge that turns with it. The energy is known up to whole turns
/// of 2 pi M, the derivatives are exact.
struct PlanarMoment {
  static constexpr int kDofs = 4;
  static constexpr int kNodes = 2;
  static constexpr EnergyTerm kTerm = EnergyTerm::Load;
  struct Constants {
    double share = 1.0;  ///< part of the moment that this edge takes [-]
    Index moment = -1;   ///< control that holds the moment [N m]
  };

  /// The energy [J] is known up to multiples of this.
  static double period(const Constants& c, const Configuration& here) {
    return 2.0 * kPi * std::abs(c.share * here.controls[c.moment]);
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    const double moment = c.share * here.controls[c.moment];
    const Vec2 e = x.tail<2>() - x.head<2>();
    out.energy = -moment * angle_between(Vec2::UnitX(), e);
    if constexpr (D == Derivatives::Energy) return;

    const double w = 1.0 / e.squaredNorm();
    const Vec2 d = direction_gradient(e, w);
    out.gradient.head<2>() = moment * d;
    out.gradient.tail<2>() = -moment * d;
    if constexpr (D == Derivatives::Gradient) return;

    const Mat2 h = -moment * direction_hessian(e, d, w);
    out.hessian.topLeftCorner<2, 2>() = h;
    out.hessian.bottomLeftCorner<2, 2>() = -h;
    out.hessian.bottomRightCorner<2, 2>() = h;
  }
};

}  // namespace der
