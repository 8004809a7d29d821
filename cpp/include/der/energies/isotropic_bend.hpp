#pragma once

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/curvature_binormal.hpp"
#include "der/kinematics/held_frame.hpp"

namespace der {

/// E = 1/2 B |kb|^2 of a joint whose bending stiffness B is the same in all directions and whose
/// rest shape is straight, with its derivatives by the unit tangents of its two edges: for dE/dd =
/// -B p(d), d = ta . tb, p is f for `angle` and f^2 for `tangent`.
struct IsotropicResponse {
  double energy = 0.0;
  double slope = 0.0;      ///< dE/dd [N m]
  double curvature = 0.0;  ///< d2E/dd2 [N m]
};

template <class Curvature>
IsotropicResponse isotropic_response(double stiffness, double cosine) {
  const BinormalFactor factor = Binormal<Curvature>::of(cosine);
  // Powers of f in p: kb is the angle itself, or the tangent of its half.
  constexpr double power = std::is_same_v<Curvature, AngleCurvature> ? 1.0 : 2.0;
  const double p = power == 1.0 ? factor.f : factor.f * factor.f;
  const double sine_squared = (1.0 - cosine) * (1.0 + cosine);
  return {0.5 * stiffness * factor.f * factor.f * sine_squared, -stiffness * p,
          -stiffness * p * power * factor.log_slope};
}

/// Derivatives of an energy by an edge vector e, of length l, which it depends on through its unit
/// tangent t and d = t . other.
struct TangentTerm {
  Vec3 tangent;
  Vec3 by_edge;  ///< dd/de = (other - d t)/l
  double per_length;

  TangentTerm(const Vec3& edge, double length) : tangent(edge / length), per_length(1.0 / length) {}
  void see(const Vec3& other, double cosine) { by_edge = per_length * (other - cosine * tangent); }
  /// d2d/de2.
  [[nodiscard]] Mat3 second(double cosine) const {
    Mat3 m = -per_length * (by_edge * tangent.transpose() + tangent * by_edge.transpose());
    m += cosine * per_length * per_length * (tangent * tangent.transpose() - Mat3::Identity());
    return m;
  }
};

/// Bending in space of a rod with the same stiffness in all directions that is straight without
/// stress: the model `spatial_bend`, which needs no frames. Coordinates: the three nodes.
template <class Curvature>
struct IsotropicBend {
  static constexpr int kDofs = 9;
  static constexpr int kNodes = 3;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Constants {
    double stiffness_per_length = 0.0;  ///< EI over the cell length [N m]
  };

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& /*here*/,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    const Vec3 ea = x.segment<3>(3) - x.segment<3>(0);
    const Vec3 eb = x.segment<3>(6) - x.segment<3>(3);
    TangentTerm a(ea, ea.norm());
    TangentTerm b(eb, eb.norm());
    const double cosine = a.tangent.dot(b.tangent);
    const IsotropicResponse bend = isotropic_response<Curvature>(c.stiffness_per_length, cosine);
    out.energy = bend.energy;
    if constexpr (D == Derivatives::Energy) return;
    a.see(b.tangent, cosine);
    b.see(a.tangent, cosine);
    const Vec3 force_a = bend.slope * a.by_edge;
    const Vec3 force_b = bend.slope * b.by_edge;
    out.gradient << -force_a, force_a - force_b, force_b;
    if constexpr (D == Derivatives::Gradient) return;

    const Mat3 aa =
        bend.curvature * a.by_edge * a.by_edge.transpose() + bend.slope * a.second(cosine);
    const Mat3 bb =
        bend.curvature * b.by_edge * b.by_edge.transpose() + bend.slope * b.second(cosine);
    // d2d/de_b de_a = (I - tb tb')(I - ta ta')/(lb la).
    const Mat3 across_b = b.per_length * (Mat3::Identity() - b.tangent * b.tangent.transpose());
    const Mat3 across_a = a.per_length * (Mat3::Identity() - a.tangent * a.tangent.transpose());
    const Mat3 ba =
        bend.curvature * b.by_edge * a.by_edge.transpose() + bend.slope * across_b * across_a;
    auto& h = out.hessian;
    h.template block<3, 3>(0, 0) = aa;
    h.template block<3, 3>(3, 0) = ba - aa;
    h.template block<3, 3>(6, 0) = -ba;
    h.template block<3, 3>(3, 3) = aa - ba - ba.transpose() + bb;
    h.template block<3, 3>(6, 3) = ba - bb;
    h.template block<3, 3>(6, 6) = bb;
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

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    const Vec3 e = x.segment<3>(3) - x.segment<3>(0);
    TangentTerm edge(e, e.norm());
    const Vec3 held = c.held.tangent(here.controls);
    const double cosine = edge.tangent.dot(held);
    const IsotropicResponse bend = isotropic_response<Curvature>(c.stiffness_per_length, cosine);
    out.energy = bend.energy;
    if constexpr (D == Derivatives::Energy) return;
    edge.see(held, cosine);
    const Vec3 force = bend.slope * edge.by_edge;
    out.gradient << -force, force;
    if constexpr (D == Derivatives::Gradient) return;

    const Mat3 own =
        bend.curvature * edge.by_edge * edge.by_edge.transpose() + bend.slope * edge.second(cosine);
    auto& h = out.hessian;
    h.template block<3, 3>(0, 0) = own;
    h.template block<3, 3>(3, 0) = -own;
    h.template block<3, 3>(3, 3) = own;
  }
};

}  // namespace der
