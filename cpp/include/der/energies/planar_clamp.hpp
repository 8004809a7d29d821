#pragma once

#include <cmath>
#include <tuple>

#include "der/core/types.hpp"
#include "der/energies/edge_blocks.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/natural_strain_offset.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {

/// Bending of the cell between a clamped tangent and the edge next to it, which is about half an
/// edge long: E = 1/2 EI (kappa - rest_kappa)^2 / c. Holding two nodes instead would make this cell
/// rigid, an error of order l. supports/clamp.hpp gives c and the pivot that the edge starts from.
template <class Curvature>
struct PlanarClamp {
  static constexpr int kDofs = 4;
  static constexpr int kNodes = 2;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Constants {
    double stiffness_per_length = 0.0;  ///< EI / c [N m]
    double rest_kappa = 0.0;            ///< natural curvature integrated over the cell [-]
    double direction = 0.0;             ///< initial angle of the clamped tangent [rad]
    double side = 1.0;                  ///< +1: the edge leaves the clamp, -1: it arrives there
    Index rotation = -1;                ///< control that turns the tangent [rad]; -1: none
    NaturalStrainOffset actuated{};     ///< of `rest_kappa`

    [[nodiscard]] double natural(const Vector& controls) const {
      return rest_kappa + actuated.value(controls);
    }
  };

  template <class T>
  struct Values {
    T stiffness_per_length = 0.0;  ///< [N m]
    T natural = 0.0;               ///< [-]
    Vector2<T> tangent;            ///< the clamped one
    T side = 1.0;
    auto fields() { return std::tie(stiffness_per_length, natural, tangent, side); }
  };
  static Values<double> values(const Constants& c, const Vector& controls) {
    const double direction = c.direction + (c.rotation >= 0 ? controls[c.rotation] : 0.0);
    return {c.stiffness_per_length,
            c.natural(controls),
            {std::cos(direction), std::sin(direction)},
            c.side};
  }

  /// Angle [rad] by which the cell turns, at the vector `e` of its edge.
  template <class T>
  static T turning_angle(const Values<T>& c, const Vector2<T>& e) {
    return c.side * angle_between<T>(c.tangent, e);
  }
  static double turning_angle(const Constants& c, const Vector& controls, const Vec2& e) {
    return turning_angle<double>(values(c, controls), e);
  }

  template <Derivatives D, class T>
  static void evaluate(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x,
                       LocalTerm<kDofs, T>& out) {
    const Vector2<T> e = x.template tail<2>() - x.template head<2>();
    const BendResponseOf<T> bend =
        bend_response<Curvature>(c.stiffness_per_length, c.natural, turning_angle<T>(c, e));
    out.energy = bend.energy;
    if constexpr (D == Derivatives::Energy) return;

    const T w = 1.0 / e.squaredNorm();
    const Vector2<T> d = direction_gradient<T>(e, w);
    const T moment = c.side * bend.moment;
    out.gradient.template head<2>() = -moment * d;
    out.gradient.template tail<2>() = moment * d;
    if constexpr (D == Derivatives::Gradient) return;

    const Eigen::Matrix<T, 2, 2> h =
        bend.stiffness * d * d.transpose() + moment * direction_hessian<T>(e, d, w);
    set_edge_blocks(h, out.hessian);
  }
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    evaluate<D, double>(values(c, here.controls), x, out);
  }
};

}  // namespace der
