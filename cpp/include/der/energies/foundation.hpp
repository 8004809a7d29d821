#pragma once

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// An elastic (Winkler) foundation under an edge, or under a part of it: springs along the rod that
/// pull every point to where it is drawn. The displacement u is linear along the edge, so that
///   E = 1/2 integral u^T k u ds = 1/2 k (L00 u0^2 + 2 L01 u0 u1 + L11 u1^2),   k diagonal,
/// with L_ij the integral of the product of the shape functions over the part that has a
/// foundation. On a whole edge L is l/6 [2 1; 1 2], the consistent matrix of linear interpolation.
struct Foundation {
  static constexpr int kDofs = 4;
  static constexpr EnergyTerm kTerm = EnergyTerm::Spring;
  struct Constants {
    Vec2 stiffness = Vec2::Zero();                      ///< [N/m^2] along x and y
    Eigen::Vector4d drawn = Eigen::Vector4d::Zero();    ///< positions without force [m]
    Eigen::Matrix2d lengths = Eigen::Matrix2d::Zero();  ///< L, symmetric [m]
  };

  /// Stiffness [N/m] against moving the edge along an axis; 0: the foundation does not hold it
  /// there.
  static double holding_stiffness(const Constants& c, int component) {
    return c.stiffness[component] * c.lengths.sum();
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& /*here*/, const Eigen::Vector4d& x,
                       LocalTerm<kDofs>& out) {
    const Eigen::Vector4d displacement = x - c.drawn;
    // Column i is the force on node i.
    const Eigen::Matrix2d force =
        c.stiffness.asDiagonal() *
        (Eigen::Map<const Eigen::Matrix2d>(displacement.data()) * c.lengths);
    const Eigen::Map<const Eigen::Vector4d> gradient(force.data());
    out.energy = 0.5 * gradient.dot(displacement);
    if constexpr (D == Derivatives::Energy) return;

    out.gradient = gradient;
    if constexpr (D == Derivatives::Gradient) return;

    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        out.hessian.block<2, 2>(2 * i, 2 * j) = (c.lengths(i, j) * c.stiffness).asDiagonal();
      }
    }
  }
};

}  // namespace der
