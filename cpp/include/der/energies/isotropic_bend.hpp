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

/// The unit tangent t of an edge of length l, on which an energy depends through d = t . other.
struct TangentTerm {
  Vec3 tangent;
  double per_length;  ///< 1/l [1/m]

  TangentTerm(const Vec3& edge, double length) : tangent(edge / length), per_length(1.0 / length) {}
  /// dd/de = (other - d t)/l.
  [[nodiscard]] Vec3 first(const Vec3& other, double cosine) const {
    return per_length * (other - cosine * tangent);
  }
  /// d2d/de2, from dd/de.
  [[nodiscard]] Mat3 second(const Vec3& by_edge, double cosine) const {
    Mat3 m = -per_length * (by_edge * tangent.transpose() + tangent * by_edge.transpose());
    m += cosine * per_length * per_length * (tangent * tangent.transpose() - Mat3::Identity());
    return m;
  }
  /// dt/de.
  [[nodiscard]] Mat3 across() const {
    return per_length * (Mat3::Identity() - tangent * tangent.transpose());
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
    const TangentTerm a(ea, ea.norm());
    const TangentTerm b(eb, eb.norm());
    const double cosine = a.tangent.dot(b.tangent);
    const IsotropicResponse bend = isotropic_response<Curvature>(c.stiffness_per_length, cosine);
    out.energy = bend.energy;
    if constexpr (D == Derivatives::Energy) return;
    const Vec3 by_a = a.first(b.tangent, cosine);
    const Vec3 by_b = b.first(a.tangent, cosine);
    const Vec3 force_a = bend.slope * by_a;
    const Vec3 force_b = bend.slope * by_b;
    out.gradient << -force_a, force_a - force_b, force_b;
    if constexpr (D == Derivatives::Gradient) return;

    const Mat3 aa = bend.curvature * by_a * by_a.transpose() + bend.slope * a.second(by_a, cosine);
    const Mat3 bb = bend.curvature * by_b * by_b.transpose() + bend.slope * b.second(by_b, cosine);
    const Mat3 ba =
        bend.curvature * by_b * by_a.transpose() + bend.slope * (b.across() * a.across());
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
    const TangentTerm edge(e, e.norm());
    const Vec3 held = c.held.tangent(here.controls);
    const double cosine = edge.tangent.dot(held);
    const IsotropicResponse bend = isotropic_response<Curvature>(c.stiffness_per_length, cosine);
    out.energy = bend.energy;
    if constexpr (D == Derivatives::Energy) return;
    const Vec3 by_edge = edge.first(held, cosine);
    const Vec3 force = bend.slope * by_edge;
    out.gradient << -force, force;
    if constexpr (D == Derivatives::Gradient) return;

    const Mat3 own =
        bend.curvature * by_edge * by_edge.transpose() + bend.slope * edge.second(by_edge, cosine);
    auto& h = out.hessian;
    h.template block<3, 3>(0, 0) = own;
    h.template block<3, 3>(3, 0) = -own;
    h.template block<3, 3>(3, 3) = own;
  }
};

}  // namespace der
