#pragma once

#include <cmath>
#include <tuple>
#include <utility>

#include "der/core/types.hpp"
#include "der/energies/edge_blocks.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/curvature_measure.hpp"
#include "der/kinematics/natural_strain_offset.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {

/// First and second derivative of 1/2 EI (kappa(phi) - rest_kappa)^2 / l by the turning angle phi.
template <class T>
struct BendResponseOf {
  T energy = 0.0;
  T moment = 0.0;     ///< dE/dphi [N m]
  T stiffness = 0.0;  ///< d2E/dphi2 [N m]
};
using BendResponse = BendResponseOf<double>;

template <class Curvature, class T>
BendResponseOf<T> bend_response(const T& stiffness_per_length, const T& rest_kappa, const T& phi) {
  const CurvatureValueOf<T> k = Curvature::of(phi);
  const T excess = k.kappa - rest_kappa;
  return {0.5 * stiffness_per_length * excess * excess, stiffness_per_length * excess * k.first,
          stiffness_per_length * (k.first * k.first + excess * k.second)};
}

/// Bending at a node between the edges e0 = x1 - x0 and e1 = x2 - x1:
/// E = 1/2 EI (kappa - rest_kappa)^2 / l_v with the Voronoi length l_v = (l0 + l1)/2 and kappa a
/// function of the signed turning angle phi from e0 to e1 (Bergou et al. 2008, section 4.2.1).
template <class Curvature>
struct PlanarBend {
  static constexpr int kDofs = 6;
  static constexpr int kNodes = 3;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Constants {
    double stiffness_per_length = 0.0;  ///< EI / l_v [N m]
    double rest_kappa = 0.0;            ///< integrated natural curvature [-]
    NaturalStrainOffset actuated{};     ///< of `rest_kappa`

    [[nodiscard]] bool is_actuated() const { return actuated.entry >= 0; }
    [[nodiscard]] double natural(const Vector& controls) const {
      return rest_kappa + actuated.value(controls);
    }
  };

  template <class T>
  struct Values {
    T stiffness_per_length = 0.0;  ///< [N m]
    T natural = 0.0;               ///< [-]
    auto fields() { return std::tie(stiffness_per_length, natural); }
  };
  static Values<double> values(const Constants& c, const Vector& controls) {
    return {c.stiffness_per_length, c.natural(controls)};
  }

  /// The vectors of the edges before and after the node, from the values at their ends.
  template <class T = double>
  static std::pair<Vector2<T>, Vector2<T>> edges(const Eigen::Matrix<T, kDofs, 1>& x) {
    return {x.template segment<2>(2) - x.template segment<2>(0),
            x.template segment<2>(4) - x.template segment<2>(2)};
  }

  template <Derivatives D, class T>
  static void evaluate(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x,
                       LocalTerm<kDofs, T>& out) {
    using Block = Eigen::Matrix<T, 2, 2>;
    const auto [e0, e1] = edges<T>(x);
    const BendResponseOf<T> bend =
        bend_response<Curvature>(c.stiffness_per_length, c.natural, angle_between<T>(e0, e1));
    out.energy = bend.energy;
    if constexpr (D == Derivatives::Energy) return;

    // phi = direction(e1) - direction(e0), hence dphi/de0 = -d0 and dphi/de1 = d1.
    const T w0 = 1.0 / e0.squaredNorm();
    const T w1 = 1.0 / e1.squaredNorm();
    const Vector2<T> d0 = direction_gradient<T>(e0, w0);
    const Vector2<T> d1 = direction_gradient<T>(e1, w1);
    out.gradient.template segment<2>(0) = bend.moment * d0;
    out.gradient.template segment<2>(2) = -bend.moment * (d0 + d1);
    out.gradient.template segment<2>(4) = bend.moment * d1;
    if constexpr (D == Derivatives::Gradient) return;

    // Hessian by the edge vectors (h00, h10 = h01', h11), then by the nodes they run between.
    const Block h00 =
        bend.stiffness * d0 * d0.transpose() - bend.moment * direction_hessian<T>(e0, d0, w0);
    const Block h11 =
        bend.stiffness * d1 * d1.transpose() + bend.moment * direction_hessian<T>(e1, d1, w1);
    const Block h10 = -bend.stiffness * d1 * d0.transpose();
    set_vertex_blocks(h00, h10, h11, out.hessian);
  }
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    evaluate<D, double>(values(c, here.controls), x, out);
  }
};

}  // namespace der
