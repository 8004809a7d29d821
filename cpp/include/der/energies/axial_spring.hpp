#pragma once

#include "der/core/types.hpp"
#include "der/energies/edge_blocks.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A linear spring along the line between two nodes, E = 1/2 k (|e| - l)^2 with e = x1 - x0 and
/// a rest length l that is a control. One of rest length 0 is linear in the positions, too, and has
/// a force of 0 where the nodes meet. There may be a damping beside it (StrainRate), and it may be
/// that alone.
template <int Dim>
struct AxialSpring {
  static constexpr int kDofs = 2 * Dim;
  static constexpr int kNodes = 2;
  static constexpr EnergyTerm kTerm = EnergyTerm::Spring;
  using Vec = Eigen::Matrix<double, Dim, 1>;
  using Coordinates = Eigen::Matrix<double, kDofs, 1>;
  struct Constants {
    double stiffness = 0.0;  ///< [N/m]
    Index rest_length = -1;  ///< number of the control that is l [m]

    /// Stiffness [N/m] across the spring, tension over length, at a length [m].
    [[nodiscard]] double across(const Vector& controls, double length) const {
      const double rest = controls[rest_length];
      return rest == 0.0 ? stiffness : stiffness * (1.0 - rest / length);
    }
  };

  /// The vector between the nodes, or the change of it, from the values at them.
  static Vec vector(const Coordinates& x) {
    return x.template tail<Dim>() - x.template head<Dim>();
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here, const Coordinates& x,
                       LocalTerm<kDofs>& out) {
    const Vec e = vector(x);
    const double length = e.norm();
    const double extension = length - here.controls[c.rest_length];
    out.energy = 0.5 * c.stiffness * extension * extension;
    if constexpr (D == Derivatives::Energy) return;

    const double across = c.across(here.controls, length);
    out.gradient << -across * e, across * e;
    if constexpr (D == Derivatives::Gradient) return;

    const Vec tangent = e.normalized();
    Eigen::Matrix<double, Dim, Dim> block = (c.stiffness - across) * tangent * tangent.transpose();
    block.diagonal().array() += across;
    set_edge_blocks(block, out.hessian);
  }
};

}  // namespace der
