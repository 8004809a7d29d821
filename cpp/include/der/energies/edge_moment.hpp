#pragma once

#include "der/core/types.hpp"
#include "der/energies/edge_blocks.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/edge_frame.hpp"

namespace der {

/// Sets the derivatives of an element that acts on the section of one edge, by the edge's two nodes
/// and its angle: the moment [N m] with dE = moment . omega, and `stiffness` [N m], S in the
/// moment's own change (S - 1/2 [moment]x) omega (EdgeFrame::geometric_stiffness).
template <Derivatives D, class T>
void set_edge_moment(const EdgeFrameOf<T>& edge, const Vector3<T>& moment,
                     const Matrix3<T>& stiffness, LocalTerm<7, T>& out) {
  using Rotation = typename EdgeFrameOf<T>::Rotation;
  const Rotation turn = edge.rotation();
  const Eigen::Matrix<T, 4, 1> force = turn.transpose() * moment;
  out.gradient << -force.template head<3>(), force.template head<3>(), force[3];
  if constexpr (D == Derivatives::Gradient) return;

  const Rotation turned = stiffness * turn;
  const Eigen::Matrix<T, 4, 4> own = turn.transpose() * turned + edge.geometric_stiffness(moment);
  auto& h = out.hessian;
  set_edge_blocks<Matrix3<T>>(own.template topLeftCorner<3, 3>(), h);
  h.template block<1, 3>(6, 0) = -own.template bottomLeftCorner<1, 3>();
  h.template block<1, 3>(6, 3) = own.template bottomLeftCorner<1, 3>();
  h(6, 6) = own(3, 3);
}

/// The moment [N m] of an element on the section of one of its edges, and `stiffness` [N m] in its
/// change by the rotation of this edge, as above.
template <class T>
struct SectionMoment {
  const EdgeFrameOf<T>& edge;
  Vector3<T> moment;
  Matrix3<T> stiffness;
};

/// The same for an element that acts on the sections of two neighbouring edges, by their three
/// nodes and two angles. The moment on b changes by `coupling` [N m] times the rotation of a.
template <Derivatives D, class T>
void set_edge_moments(const SectionMoment<T>& a, const SectionMoment<T>& b,
                      const Matrix3<T>& coupling, LocalTerm<11, T>& out) {
  using Rotation = typename EdgeFrameOf<T>::Rotation;
  using Variables = Eigen::Matrix<T, 4, 1>;
  using Block = Eigen::Matrix<T, 4, 4>;
  const Rotation turn_a = a.edge.rotation();
  const Rotation turn_b = b.edge.rotation();
  const Variables force_a = turn_a.transpose() * a.moment;
  const Variables force_b = turn_b.transpose() * b.moment;
  out.gradient << -force_a.template head<3>(),
      force_a.template head<3>() - force_b.template head<3>(), force_b.template head<3>(),
      force_a[3], force_b[3];
  if constexpr (D == Derivatives::Gradient) return;

  // By the vectors and angles of the edges, then by the nodes that these run between.
  const auto on_itself = [](const SectionMoment<T>& on, const Rotation& turn) -> Block {
    const Rotation turned = on.stiffness * turn;
    return turn.transpose() * turned + on.edge.geometric_stiffness(on.moment);
  };
  const Block aa = on_itself(a, turn_a);
  const Block bb = on_itself(b, turn_b);
  const Rotation coupled = coupling * turn_a;
  const Block ba = turn_b.transpose() * coupled;
  auto& h = out.hessian;
  set_vertex_blocks<Matrix3<T>>(aa.template topLeftCorner<3, 3>(),
                                ba.template topLeftCorner<3, 3>(),
                                bb.template topLeftCorner<3, 3>(), h);
  using Row = Eigen::Matrix<T, 1, 3>;
  const Row aa_te = aa.template bottomLeftCorner<1, 3>();
  const Row bb_te = bb.template bottomLeftCorner<1, 3>();
  const Row ba_te = ba.template bottomLeftCorner<1, 3>();            // theta_b by e_a
  const Row ab_te = ba.template topRightCorner<3, 1>().transpose();  // theta_a by e_b
  h.template block<1, 3>(9, 0) = -aa_te;
  h.template block<1, 3>(9, 3) = aa_te - ab_te;
  h.template block<1, 3>(9, 6) = ab_te;
  h.template block<1, 3>(10, 0) = -ba_te;
  h.template block<1, 3>(10, 3) = ba_te - bb_te;
  h.template block<1, 3>(10, 6) = bb_te;
  h(9, 9) = aa(3, 3);
  h(10, 9) = ba(3, 3);
  h(10, 10) = bb(3, 3);
}

}  // namespace der
