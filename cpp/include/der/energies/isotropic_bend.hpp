#pragma once

#include <tuple>

#include "der/core/types.hpp"
#include "der/energies/edge_blocks.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/curvature_binormal.hpp"
#include "der/kinematics/held_frame.hpp"

namespace der {

/// E = 1/2 B |kb|^2 of a vertex whose bending stiffness B is the same in all directions and whose
/// rest shape is straight, with its derivatives by the unit tangents of its two edges: for dE/dd =
/// -B p(d), d = ta . tb, p is f for `angle` and f^2 for `tangent`.
template <class T>
struct IsotropicResponse {
  T slope = 0.0;      ///< dE/dd [N m]
  T curvature = 0.0;  ///< d2E/dd2 [N m]
};

template <class Curvature, class T>
IsotropicResponse<T> isotropic_response(const T& stiffness, const T& cosine) {
  const BinormalFactor<T> factor = Binormal<Curvature>::of(cosine);
  // Powers of f in p: kb is the angle itself, or the tangent of its half.
  constexpr double power = std::is_same_v<Curvature, AngleCurvature> ? 1.0 : 2.0;
  const T p = power == 1.0 ? factor.f : factor.f * factor.f;
  return {-stiffness * p, -stiffness * p * power * factor.log_slope};
}

/// The energy of that vertex [J]. The sine is that of the cross product: 1 - d^2 would leave B
/// times the rounding error of d at every straight vertex.
template <class Curvature, class T>
T isotropic_energy(const T& stiffness, const Vector3<T>& ta, const Vector3<T>& tb) {
  const T f = Binormal<Curvature>::template of<T>(ta.dot(tb)).f;
  return 0.5 * stiffness * f * f * ta.cross(tb).squaredNorm();
}

/// The unit tangent t of an edge of length l, on which an energy depends through d = t . other.
template <class T>
struct TangentTermOf {
  T length;      ///< [m]
  T per_length;  ///< 1/l [1/m]
  Vector3<T> tangent;

  explicit TangentTermOf(const Vector3<T>& edge)
      : length(edge.norm()), per_length(1.0 / length), tangent(per_length * edge) {}
  /// dd/de = (other - d t)/l.
  [[nodiscard]] Vector3<T> first(const Vector3<T>& other, const T& cosine) const {
    return per_length * (other - cosine * tangent);
  }
  /// d2d/de2, from dd/de.
  [[nodiscard]] Matrix3<T> second(const Vector3<T>& by_edge, const T& cosine) const {
    Matrix3<T> m = -per_length * (by_edge * tangent.transpose() + tangent * by_edge.transpose());
    m +=
        cosine * per_length * per_length * (tangent * tangent.transpose() - Matrix3<T>::Identity());
    return m;
  }
  /// dt/de.
  [[nodiscard]] Matrix3<T> across() const {
    return per_length * (Matrix3<T>::Identity() - tangent * tangent.transpose());
  }
};
using TangentTerm = TangentTermOf<double>;

/// Bending in space of a rod with the same stiffness in all directions that is straight without
/// stress: the model `spatial_bend`, which needs no frames. Coordinates: the three nodes.
template <class Curvature>
struct IsotropicBend {
  static constexpr int kDofs = 9;
  static constexpr int kNodes = 3;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Constants {
    double stiffness_per_length = 0.0;  ///< EI over the cell length [N m]
    [[nodiscard]] static bool is_actuated() { return false; }
  };

  template <class T>
  struct Values {
    T stiffness_per_length = 0.0;  ///< [N m]
    auto fields() { return std::tie(stiffness_per_length); }
  };
  static Values<double> values(const Constants& c, const Vector& /*controls*/) {
    return {c.stiffness_per_length};
  }

  template <Derivatives D, class T>
  static void evaluate(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x,
                       LocalTerm<kDofs, T>& out) {
    using Vec = Vector3<T>;
    using Mat = Matrix3<T>;
    const Vec ea = x.template segment<3>(3) - x.template segment<3>(0);
    const Vec eb = x.template segment<3>(6) - x.template segment<3>(3);
    const TangentTermOf<T> a(ea);
    const TangentTermOf<T> b(eb);
    out.energy = isotropic_energy<Curvature, T>(c.stiffness_per_length, a.tangent, b.tangent);
    if constexpr (D == Derivatives::Energy) return;
    const T cosine = a.tangent.dot(b.tangent);
    const auto bend = isotropic_response<Curvature, T>(c.stiffness_per_length, cosine);
    const Vec by_a = a.first(b.tangent, cosine);
    const Vec by_b = b.first(a.tangent, cosine);
    const Vec force_a = bend.slope * by_a;
    const Vec force_b = bend.slope * by_b;
    out.gradient << -force_a, force_a - force_b, force_b;
    if constexpr (D == Derivatives::Gradient) return;

    const Mat aa = bend.curvature * by_a * by_a.transpose() + bend.slope * a.second(by_a, cosine);
    const Mat bb = bend.curvature * by_b * by_b.transpose() + bend.slope * b.second(by_b, cosine);
    const Mat ba =
        bend.curvature * by_b * by_a.transpose() + bend.slope * (b.across() * a.across());
    set_vertex_blocks(aa, ba, bb, out.hessian);
  }
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    evaluate<D, double>(values(c, here.controls), x, out);
  }
};

/// Bending of the cell between a held tangent and the edge next to it, of such a rod. Coordinates:
/// the two nodes.
template <class Curvature>
struct IsotropicClamp {
  static constexpr int kDofs = 6;
  static constexpr int kNodes = 2;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Constants {
    double stiffness_per_length = 0.0;  ///< EI over the cell length [N m]
    HeldFrame held;
  };

  template <class T>
  struct Values {
    T stiffness_per_length = 0.0;  ///< [N m]
    Vector3<T> held;               ///< tangent
    auto fields() { return std::tie(stiffness_per_length, held); }
  };
  static Values<double> values(const Constants& c, const Vector& controls) {
    return {c.stiffness_per_length, c.held.tangent(controls)};
  }

  template <Derivatives D, class T>
  static void evaluate(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x,
                       LocalTerm<kDofs, T>& out) {
    const Vector3<T> e = x.template segment<3>(3) - x.template segment<3>(0);
    const TangentTermOf<T> edge(e);
    out.energy = isotropic_energy<Curvature, T>(c.stiffness_per_length, edge.tangent, c.held);
    if constexpr (D == Derivatives::Energy) return;
    const T cosine = edge.tangent.dot(c.held);
    const auto bend = isotropic_response<Curvature, T>(c.stiffness_per_length, cosine);
    const Vector3<T> by_edge = edge.first(c.held, cosine);
    const Vector3<T> force = bend.slope * by_edge;
    out.gradient << -force, force;
    if constexpr (D == Derivatives::Gradient) return;

    const Matrix3<T> own =
        bend.curvature * by_edge * by_edge.transpose() + bend.slope * edge.second(by_edge, cosine);
    set_edge_blocks(own, out.hessian);
  }
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    evaluate<D, double>(values(c, here.controls), x, out);
  }
};

}  // namespace der
