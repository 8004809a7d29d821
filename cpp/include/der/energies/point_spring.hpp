#pragma once

#include <tuple>

#include "der/core/sum_of.hpp"
#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A linear spring between an anchor a and a point p = sum w_i x_i of a rod, w the weights of a
/// place (model/node_weights.hpp): E = 1/2 (p - a)^T k (p - a), k diagonal. With the weights of a
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

  template <class T>
  struct Values {
    Eigen::Matrix<T, Dim, 1> stiffness;  ///< [N/m]
    Eigen::Matrix<T, Dim, 1> anchor;     ///< [m]
    Eigen::Matrix<T, Nodes, 1> weights;
    auto fields() { return std::tie(stiffness, anchor, weights); }
  };
  static Values<double> values(const Constants& c, const Vector& /*controls*/) {
    return {c.stiffness, c.anchor, c.weights};
  }

  template <Derivatives D, class T>
  static void evaluate(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x,
                       LocalTerm<kDofs, T>& out) {
    using PointOf = Eigen::Matrix<T, Dim, 1>;
    // Summed up node by node, so that the order is the same for every number type.
    PointOf point = x.template head<Dim>() * c.weights[0];
    for (int i = 1; i < Nodes; ++i) point += x.template segment<Dim>(Dim * i) * c.weights[i];
    const PointOf stretch = point - c.anchor;
    const PointOf force = c.stiffness.cwiseProduct(stretch);
    out.energy = 0.5 * ordered_dot(force, stretch);
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
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    evaluate<D, double>(values(c, here.controls), x, out);
  }
};

}  // namespace der
