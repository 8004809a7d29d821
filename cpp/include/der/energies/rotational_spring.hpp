#pragma once

#include <array>
#include <cmath>

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/natural_strain_offset.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {

/// A spring against turning: E = 1/2 k (sum w_i theta_i - rest)^2, theta the direction angles of
/// one edge, or of two that share a node, from the drawn direction of the first.
/// supports/spring.hpp says how the tangent of a rod is such a sum. The weights add up to 1 but
/// beside a clamp, whose tangent has the rest. The first edge is within half a turn of where the
/// state has followed it to (model/followed.hpp), so that the spring winds up without an end.
template <int Edges>
struct RotationalSpring {
  static_assert(Edges == 1 || Edges == 2);
  static constexpr int kNodes = Edges + 1;
  static constexpr int kDofs = 2 * kNodes;
  static constexpr EnergyTerm kTerm = EnergyTerm::Spring;
  struct Constants {
    double stiffness = 0.0;               ///< [N m/rad]
    double direction = 0.0;               ///< of the first edge as drawn [rad]
    double rest = 0.0;                    ///< [rad]
    std::array<double, Edges> weights{};  ///< [-]
    double total = 1.0;                   ///< of the weights
    Index turn = -1;               ///< control that holds how far the first edge has turned [rad]
    NaturalStrainOffset actuated;  ///< how far actuations turn the tangent beyond the sum [rad]
    double clamp_share = 0.0;  ///< share of the turn of a clamp beside it that the tangent has [-]
    Index clamp_turn = -1;     ///< control: how far that clamp has turned [rad]; -1: it does not

    /// The turn of the tangent that controls add to the sum [rad].
    [[nodiscard]] double turned_by(const Vector& controls) const {
      return actuated.value(controls) + (clamp_turn < 0 ? 0.0 : clamp_share * controls[clamp_turn]);
    }
  };

  /// sum w_i theta_i - rest [rad] without what controls add, the first edge being within half a
  /// turn of `before` [rad].
  static double turn(const Constants& c, double before, const Eigen::Matrix<double, kDofs, 1>& x) {
    const Vec2 then{std::cos(c.direction + before), std::sin(c.direction + before)};
    const Vec2 first = x.template segment<2>(2) - x.template segment<2>(0);
    double turn = c.total * (before + angle_between(then, first)) - c.rest;
    if constexpr (Edges == 2) {
      const Vec2 second = x.template segment<2>(4) - x.template segment<2>(2);
      turn += c.weights[1] * angle_between(first, second);
    }
    return turn;
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    using Coordinates = Eigen::Matrix<double, kDofs, 1>;
    const double turned = turn(c, here.controls[c.turn], x) + c.turned_by(here.controls);
    const double moment = c.stiffness * turned;
    out.energy = 0.5 * moment * turned;
    if constexpr (D == Derivatives::Energy) return;

    std::array<Vec2, Edges> edge;
    for (int i = 0; i < Edges; ++i) {
      edge[std::size_t(i)] = x.template segment<2>(2 * i + 2) - x.template segment<2>(2 * i);
    }
    Coordinates slope = Coordinates::Zero();  // of the turn
    std::array<double, Edges> inverse;
    std::array<Vec2, Edges> d;
    for (int i = 0; i < Edges; ++i) {
      const auto k = std::size_t(i);
      inverse[k] = 1.0 / edge[k].squaredNorm();
      d[k] = direction_gradient(edge[k], inverse[k]);
      slope.template segment<2>(2 * i) -= c.weights[k] * d[k];
      slope.template segment<2>(2 * i + 2) += c.weights[k] * d[k];
    }
    out.gradient = moment * slope;
    if constexpr (D == Derivatives::Gradient) return;

    out.hessian = c.stiffness * slope * slope.transpose();
    for (int i = 0; i < Edges; ++i) {
      const auto k = std::size_t(i);
      const Mat2 h = moment * c.weights[k] * direction_hessian(edge[k], d[k], inverse[k]);
      out.hessian.template block<2, 2>(2 * i, 2 * i) += h;
      out.hessian.template block<2, 2>(2 * i + 2, 2 * i) -= h;
      out.hessian.template block<2, 2>(2 * i + 2, 2 * i + 2) += h;
    }
  }
};

}  // namespace der
