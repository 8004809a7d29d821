#pragma once

#include <cmath>
#include <tuple>

#include "der/core/lanes.hpp"
#include "der/core/sum_of.hpp"
#include "der/core/types.hpp"
#include "der/energies/edge_blocks.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/natural_strain_offset.hpp"

namespace der {

/// Force and stiffness of a stretched edge.
template <class T>
struct StretchResponseOf {
  T extension = 0.0;  ///< [m]
  T tension = 0.0;    ///< [N]
  T along = 0.0;      ///< material stiffness along the edge [N/m]
  T across = 0.0;     ///< geometric stiffness across it, tension / length [N/m]
};
using StretchResponse = StretchResponseOf<double>;

/// `elongation` [m] of the edge without stress does not change its stiffness, `along` [N/m].
template <class T>
StretchResponseOf<T> stretch_response_along(const T& along, const T& rest_length,
                                            const T& elongation, const T& length) {
  const T extension = length - rest_length - elongation;
  const T tension = along * extension;
  return {extension, tension, along, tension / length};
}
template <class T>
StretchResponseOf<T> stretch_response(const T& EA, const T& rest_length, const T& elongation,
                                      const T& length) {
  return stretch_response_along<T>(EA / rest_length, rest_length, elongation, length);
}

/// Axial stretching of an edge: E = 1/2 EA (|e|/l - 1 - a)^2 l with e = x1 - x0, rest length l
/// (Bergou et al., Discrete Viscous Threads, SIGGRAPH 2010, eq. 3) and the elongation a by
/// actuations, which acts as a thermal strain does.
template <int Dim>
struct Stretch {
  static constexpr int kDofs = 2 * Dim;
  static constexpr int kNodes = 2;
  static constexpr EnergyTerm kTerm = EnergyTerm::Stretch;
  struct Constants {
    double EA = 0.0;                   ///< [N]
    double rest_length = 0.0;          ///< [m]
    NaturalStrainOffset elongation{};  ///< [m]
    [[nodiscard]] bool is_actuated() const { return elongation.entry >= 0; }
  };

  template <class T>
  struct Values {
    T along = 0.0;        ///< [N/m]
    T rest_length = 0.0;  ///< [m]
    T elongation = 0.0;   ///< [m]
    auto fields() { return std::tie(along, rest_length, elongation); }
  };
  static Values<double> values(const Constants& c, const Vector& controls) {
    return {c.EA / c.rest_length, c.rest_length, c.elongation.value(controls)};
  }

  /// The edge's vector, or the change of it, from the values at its ends.
  template <class T = double>
  static Eigen::Matrix<T, Dim, 1> edge(const Eigen::Matrix<T, kDofs, 1>& x) {
    return x.template tail<Dim>() - x.template head<Dim>();
  }

  template <class T>
  static StretchResponseOf<T> response(const Values<T>& c, const T& length) {
    return stretch_response_along(c.along, c.rest_length, c.elongation, length);
  }
  static StretchResponse response(const Constants& c, const Vector& controls, double length) {
    return response<double>(values(c, controls), length);
  }

  template <Derivatives D, class T>
  static void evaluate(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x,
                       LocalTerm<kDofs, T>& out) {
    using std::sqrt;
    using Vec = Eigen::Matrix<T, Dim, 1>;
    using Mat = Eigen::Matrix<T, Dim, Dim>;
    const Vec e = edge<T>(x);
    const T length = sqrt(ordered_dot(e, e));
    const StretchResponseOf<T> stretch = response<T>(c, length);
    out.energy = 0.5 * stretch.tension * stretch.extension;
    if constexpr (D == Derivatives::Energy) return;

    const Vec force = stretch.across * e;
    out.gradient.template head<Dim>() = -force;
    out.gradient.template tail<Dim>() = force;
    if constexpr (D == Derivatives::Gradient) return;

    const Vec tangent = e / length;
    Mat block = (stretch.along - stretch.across) * tangent * tangent.transpose();
    block.diagonal().array() += stretch.across;
    set_edge_blocks(block, out.hessian);
  }
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    evaluate<D, double>(values(c, here.controls), x, out);
  }
};

}  // namespace der
