#pragma once

#include <cmath>
#include <tuple>

#include "der/core/types.hpp"
#include "der/kinematics/curvature_binormal.hpp"
#include "der/kinematics/material_curvature.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// Stiffnesses and rest shape of the vertex between two neighbouring edges.
template <class T>
struct VertexOf {
  T bend_1 = 0.0;               ///< EI1 over the cell length [N m]
  T bend_2 = 0.0;               ///< EI2 over the cell length [N m]
  T twist = 0.0;                ///< GJ over the cell length [N m]
  MaterialCurvatureOf<T> rest;  ///< of natural curvature and twist

  template <class U>
  using In = VertexOf<U>;
  auto fields() { return std::tuple_cat(std::tie(bend_1, bend_2, twist), rest.fields()); }
  /// The derivative of the energy by the strain [N m].
  [[nodiscard]] MaterialCurvatureOf<T> load(const MaterialCurvatureOf<T>& strain) const {
    return {bend_1 * (strain.kappa_1 - rest.kappa_1), bend_2 * (strain.kappa_2 - rest.kappa_2),
            twist * (strain.twist - rest.twist)};
  }
  /// The stiffness [N m] against rotations whose strains have the gradients g1, g2, gt.
  [[nodiscard]] Matrix3<T> stiffness(const Vector3<T>& g1, const Vector3<T>& g2,
                                     const Vector3<T>& gt) const {
    return bend_1 * g1 * g1.transpose() + bend_2 * g2 * g2.transpose() +
           twist * gt * gt.transpose();
  }
};
using Vertex = VertexOf<double>;

/// A vertex whose three strains are coupled, as those at a corner are (building/corner.hpp).
template <class T>
struct CoupledVertexOf {
  Matrix3<T> coefficients = Matrix3<T>::Zero();  ///< second derivative of the energy by the strain
                                                 ///< [N m]
  MaterialCurvatureOf<T> rest;

  template <class U>
  using In = CoupledVertexOf<U>;
  auto fields() { return std::tuple_cat(std::tie(coefficients), rest.fields()); }
  [[nodiscard]] MaterialCurvatureOf<T> load(const MaterialCurvatureOf<T>& strain) const {
    const Vector3<T> q =
        coefficients * Vector3<T>(strain.kappa_1 - rest.kappa_1, strain.kappa_2 - rest.kappa_2,
                                  strain.twist - rest.twist);
    return {q[0], q[1], q[2]};
  }
  [[nodiscard]] Matrix3<T> stiffness(const Vector3<T>& g1, const Vector3<T>& g2,
                                     const Vector3<T>& gt) const {
    Matrix3<T> gradients;
    gradients << g1, g2, gt;
    return gradients * coefficients * gradients.transpose();
  }
};
using CoupledVertex = CoupledVertexOf<double>;

/// A vertex without stiffness that bears a load whatever its strain.
struct LoadedVertex {
  MaterialCurvature rest;
  MaterialCurvature moments;  ///< [N m]

  [[nodiscard]] const MaterialCurvature& load(const MaterialCurvature& /*strain*/) const {
    return moments;
  }
  [[nodiscard]] static Mat3 stiffness(const Vec3& /*g1*/, const Vec3& /*g2*/, const Vec3& /*gt*/) {
    return Mat3::Zero();
  }
};

/// Energy [J] of a vertex and its derivatives with respect to the rotations omega_a, omega_b of its
/// two frames: dE = M . (omega_b - omega_a), and M changes by
///   dM = (S - 1/2 [M]x) omega_b - (S + 1/2 [M]x) omega_a.
/// Turning both frames turns M with them, which is why one symmetric matrix tells it all.
template <class T>
struct VertexResponseOf {
  T energy = 0.0;
  Vector3<T> moment = Vector3<T>::Zero();     ///< M [N m]
  Matrix3<T> stiffness = Matrix3<T>::Zero();  ///< S [N m]
};
using VertexResponse = VertexResponseOf<double>;

/// The side of a vertex on which nothing holds the section against turning about the tangent.
enum class FreeSide { Before, After };

/// The vertex as its two frames see it: kb = f ta x tb, read in the frame of edge a turned by half
/// of the twist, so that bending a rod of a round section does not depend on its twist however
/// large.
template <class Curvature, class T = double>
class VertexKinematics {
 public:
  /// `twist` is the whole twist [rad] between the two frames, whole turns included.
  VertexKinematics(const SectionFrameOf<T>& a, const SectionFrameOf<T>& b, const T& twist)
      : VertexKinematics(a, b, twist, 0.5 * twist, 0.5) {}

  /// The vertex to a side that holds the tangent alone. The section there spins with the edge on
  /// the other side, from which it differs by `natural`, the rest twist [rad], since no torque
  /// passes; `twist` is that between the two frames as before, which the held one does not follow.
  static VertexKinematics with_free_side(FreeSide side, const SectionFrameOf<T>& a,
                                         const SectionFrameOf<T>& b, const T& twist,
                                         const T& natural) {
    if (side == FreeSide::Before) return {a, b, natural, twist - 0.5 * natural, 1.0};
    return {a, b, natural, 0.5 * natural, 0.0};
  }

  /// The vertex with its curvature read in the directors of a, which have a meaning of their own
  /// where a bears a moment.
  static VertexKinematics read_before(const SectionFrameOf<T>& a, const SectionFrameOf<T>& b,
                                      const T& twist) {
    return {a, b, twist, 0.0, 0.0};
  }

  [[nodiscard]] const MaterialCurvatureOf<T>& strain() const { return strain_; }

  /// Energy [J] of a vertex, a VertexOf<T> or a CoupledVertexOf<T>.
  template <class AVertex>
  [[nodiscard]] T energy(const AVertex& vertex) const {
    const auto [q1, q2, torque] = vertex.load(strain_);
    return 0.5 * (q1 * (strain_.kappa_1 - vertex.rest.kappa_1) +
                  q2 * (strain_.kappa_2 - vertex.rest.kappa_2) +
                  torque * (strain_.twist - vertex.rest.twist));
  }

  /// Derivatives of the strain by omega_b, and by -omega_a.
  struct Gradients {
    Vector3<T> kappa_1;
    Vector3<T> kappa_2;
    Vector3<T> twist;
  };
  [[nodiscard]] Gradients gradients() const {
    const T h = factor_.log_slope;
    const Vector3<T> w = tb_.cross(ta_);
    const Vector3<T> gt = 1.0 / (1.0 + cosine_) * (ta_ + tb_);
    return {h * strain_.kappa_1 * w + factor_.f * tb_.cross(m1_) + share_ * strain_.kappa_2 * gt,
            h * strain_.kappa_2 * w + factor_.f * tb_.cross(m2_) - share_ * strain_.kappa_1 * gt,
            gt};
  }

  /// Sets the energy and M, and S if `with_stiffness`.
  template <bool with_stiffness, class AVertex = VertexOf<T>>
  void respond(const AVertex& vertex, VertexResponseOf<T>& out) const {
    const T& k1 = strain_.kappa_1;
    const T& k2 = strain_.kappa_2;
    const auto [q1, q2, torque] = vertex.load(strain_);
    const auto [g1, g2, gt] = gradients();
    const Vector3<T> bend = q1 * g1 + q2 * g2;
    out.energy = energy(vertex);
    out.moment = bend + torque * gt;
    if constexpr (!with_stiffness) return;

    const T h = factor_.log_slope;
    const T half = 1.0 / (1.0 + cosine_);
    const Vector3<T> w = tb_.cross(ta_);  // gradient of the cosine
    const T in_line = q1 * k1 + q2 * k2;
    const T across = q1 * k2 - q2 * k1;
    const Vector3<T> turned = q1 * g2 - q2 * g1;
    const Vector3<T> lean = h * in_line * ta_ + factor_.f * (q1 * m1_ + q2 * m2_);
    // Coefficients of w and of gt in symmetric products with them.
    const Vector3<T> with_w =
        h * bend + 0.5 * factor_.log_change * in_line * w -
        (0.5 * half * torque + (share_ * h + 0.5 * share_ * half) * across) * gt;
    const Vector3<T> with_gt = share_ * turned + 0.5 * share_ * share_ * in_line * gt;
    Matrix3<T> half_sum = 0.5 * vertex.stiffness(g1, g2, gt) + w * with_w.transpose() +
                          gt * with_gt.transpose() + 0.5 * tb_ * lean.transpose();
    half_sum.diagonal().array() -= 0.5 * in_line * (1.0 + h * cosine_);
    out.stiffness = half_sum + half_sum.transpose();
  }

 private:
  /// The curvature is read in the frame of a turned by `turn` [rad], `share` of each further twist.
  VertexKinematics(const SectionFrameOf<T>& a, const SectionFrameOf<T>& b, const T& strain,
                   const T& turn, double share)
      : ta_(a.tangent),
        tb_(b.tangent),
        cosine_(ta_.dot(tb_)),
        factor_(Binormal<Curvature>::of(cosine_)),
        share_(share) {
    const SectionFrameOf<T> middle = a.turned(turn);
    m1_ = middle.first;
    m2_ = middle.second;
    strain_ = {factor_.f * m1_.dot(tb_), factor_.f * m2_.dot(tb_), strain};
  }

  Vector3<T> ta_;
  Vector3<T> tb_;
  T cosine_;
  BinormalFactor<T> factor_;
  double share_;
  Vector3<T> m1_;
  Vector3<T> m2_;
  MaterialCurvatureOf<T> strain_;
};

}  // namespace der
