#pragma once

#include <tuple>

#include "der/core/sum_of.hpp"
#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// An elastic (Winkler) foundation under an edge, or under a part of it: springs along the rod that
/// pull every point to where it is drawn. The displacement u is linear along the edge, so that
///   E = 1/2 integral u^T k u ds = 1/2 k (L00 u0^2 + 2 L01 u0 u1 + L11 u1^2),   k diagonal,
/// with L_ij the integral of the product of the shape functions over the part that has a
/// foundation. On a whole edge L is l/6 [2 1; 1 2], the consistent matrix of linear interpolation.
template <int Dim>
struct Foundation {
  static constexpr int kDofs = 2 * Dim;
  static constexpr int kNodes = 2;
  using Ends = Eigen::Matrix<double, kDofs, 1>;
  static constexpr EnergyTerm kTerm = EnergyTerm::Spring;
  struct Constants {
    /// [N/m^2] along each axis
    Eigen::Matrix<double, Dim, 1> stiffness = Eigen::Matrix<double, Dim, 1>::Zero();
    Ends drawn = Ends::Zero();    ///< positions without force [m]
    Mat2 lengths = Mat2::Zero();  ///< L, symmetric [m]
  };

  /// Stiffness [N/m] against moving the edge along an axis; 0: the foundation does not hold it
  /// there.
  static double holding_stiffness(const Constants& c, int component) {
    return c.stiffness[component] * c.lengths.sum();
  }

  template <class T>
  struct Values {
    Eigen::Matrix<T, Dim, 1> stiffness;  ///< [N/m^2]
    Eigen::Matrix<T, kDofs, 1> drawn;    ///< [m]
    Eigen::Matrix<T, 2, 2> lengths;      ///< [m]
    auto fields() { return std::tie(stiffness, drawn, lengths); }
  };
  static Values<double> values(const Constants& c, const Vector& /*controls*/) {
    return {c.stiffness, c.drawn, c.lengths};
  }

  template <Derivatives D, class T>
  static void evaluate(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x,
                       LocalTerm<kDofs, T>& out) {
    using Columns = Eigen::Matrix<T, Dim, 2>;
    const Eigen::Matrix<T, kDofs, 1> displacement = x - c.drawn;
    // Column i is the force on node i.
    const Columns force =
        c.stiffness.asDiagonal() * (Eigen::Map<const Columns>(displacement.data()) * c.lengths);
    const Eigen::Matrix<T, kDofs, 1> gradient =
        Eigen::Map<const Eigen::Matrix<T, kDofs, 1>>(force.data());
    out.energy = 0.5 * ordered_dot(gradient, displacement);
    if constexpr (D == Derivatives::Energy) return;

    out.gradient = gradient;
    if constexpr (D == Derivatives::Gradient) return;

    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        out.hessian.template block<Dim, Dim>(Dim * i, Dim * j) =
            (c.lengths(i, j) * c.stiffness).asDiagonal();
      }
    }
  }
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here, const Ends& x,
                       LocalTerm<kDofs>& out) {
    evaluate<D, double>(values(c, here.controls), x, out);
  }
};

}  // namespace der
