#pragma once

#include <cmath>

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"

namespace der {

/// Axial stretching of an edge: E = 1/2 EA (|e|/l - 1)^2 l with e = x1 - x0 and rest length l
/// (Bergou et al., Discrete Viscous Threads, SIGGRAPH 2010, eq. 3).
template <int Dim>
struct Stretch {
  static constexpr int kDofs = 2 * Dim;
  static constexpr EnergyTerm kTerm = EnergyTerm::Stretch;
  struct Constants {
    double EA = 0.0;           ///< [N]
    double rest_length = 0.0;  ///< [m]
  };

  template <Derivatives D>
  static void evaluate(const Constants& c, const Vector& /*controls*/,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    using Vec = Eigen::Matrix<double, Dim, 1>;
    using Mat = Eigen::Matrix<double, Dim, Dim>;
    const Vec e = x.template tail<Dim>() - x.template head<Dim>();
    const double length = e.norm();
    const double strain = length / c.rest_length - 1.0;
    const double tension = c.EA * strain;
    out.energy = 0.5 * tension * strain * c.rest_length;
    if constexpr (D == Derivatives::Energy) return;

    const double inverse_length = 1.0 / length;
    const Vec tangent = inverse_length * e;
    out.gradient.template head<Dim>() = -tension * tangent;
    out.gradient.template tail<Dim>() = tension * tangent;
    if constexpr (D == Derivatives::Gradient) return;

    // Material stiffness along the edge, geometric stiffness across it.
    const double across = tension * inverse_length;
    const double along = c.EA / c.rest_length - across;
    Mat block = along * tangent * tangent.transpose();
    block.diagonal().array() += across;
    out.hessian.template topLeftCorner<Dim, Dim>() = block;
    out.hessian.template bottomLeftCorner<Dim, Dim>() = -block;
    out.hessian.template bottomRightCorner<Dim, Dim>() = block;
  }
};

}  // namespace der
