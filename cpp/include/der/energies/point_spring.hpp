#pragma once

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A linear spring between an anchor a and a point p = sum w_i x_i of a rod, w the weights of a
/// place (model/location.hpp): E = 1/2 (p - a)^T k (p - a), k diagonal. With the cubic weights of a
/// point force it converges with order 2 wherever the place lies.
template <int Dim, int Nodes>
struct PointSpring {
  static constexpr int kDofs = Dim * Nodes;
  static constexpr int kNodes = Nodes;
  using Point = Eigen::Matrix<double, Dim, 1>;
  static constexpr EnergyTerm kTerm = EnergyTerm::Spring;
  struct Constants {
    Point stiffness = Point::Zero();  ///< [N/m] along each axis
    Point anchor = Point::Zero();     ///< [m]
    Eigen::Matrix<double, Nodes, 1> weights;
  };

  /// Stiffness [N/m] against moving the rod along an axis; 0: the spring does not hold it there.
  static double holding_stiffness(const Constants& c, int component) {
    return c.stiffness[component];
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& /*here*/,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    const Point stretch =
        Eigen::Map<const Eigen::Matrix<double, Dim, Nodes>>(x.data()) * c.weights - c.anchor;
    const Point force = c.stiffness.cwiseProduct(stretch);
    out.energy = 0.5 * force.dot(stretch);
    if constexpr (D == Derivatives::Energy) return;

    for (int i = 0; i < Nodes; ++i) {
      out.gradient.template segment<Dim>(Dim * i) = c.weights[i] * force;
    }
    if constexpr (D == Derivatives::Gradient) return;

    for (int i = 0; i < Nodes; ++i) {
      for (int j = 0; j < Nodes; ++j) {
        out.hessian.template block<Dim, Dim>(Dim * i, Dim * j) =
            (c.weights[i] * c.weights[j] * c.stiffness).asDiagonal();
      }
    }
  }
};

}  // namespace der
