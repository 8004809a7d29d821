#pragma once

#include "der/core/types.hpp"
#include "der/energies/edge_blocks.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/edge_frame.hpp"

namespace der {

/// Sets the derivatives of an element that acts on the section of one edge, by the edge's two nodes
/// and its angle: the moment [N m] with dE = moment . omega, and `stiffness` [N m], S in the
/// moment's own change (S - 1/2 [moment]x) omega (EdgeFrame::geometric_stiffness).
template <Derivatives D>
void set_edge_moment(const EdgeFrame& edge, const Vec3& moment, const Mat3& stiffness,
                     LocalTerm<7>& out) {
  const EdgeFrame::Rotation turn = edge.rotation();
  const Eigen::Vector4d force = turn.transpose() * moment;
  out.gradient << -force.head<3>(), force.head<3>(), force[3];
  if constexpr (D == Derivatives::Gradient) return;

  const Eigen::Matrix4d own =
      turn.transpose() * stiffness * turn + edge.geometric_stiffness(moment);
  auto& h = out.hessian;
  set_edge_blocks<Mat3>(own.topLeftCorner<3, 3>(), h);
  h.block<1, 3>(6, 0) = -own.bottomLeftCorner<1, 3>();
  h.block<1, 3>(6, 3) = own.bottomLeftCorner<1, 3>();
  h(6, 6) = own(3, 3);
}

/// The moment [N m] of an element on the section of one of its edges, and `stiffness` [N m] in its
/// change by the rotation of this edge, as above.
struct SectionMoment {
  const EdgeFrame& edge;
  Vec3 moment;
  Mat3 stiffness;
};

/// The same for an element that acts on the sections of two neighbouring edges, by their three
/// nodes and two angles. The moment on b changes by `coupling` [N m] times the rotation of a.
template <Derivatives D>
void set_edge_moments(const SectionMoment& a, const SectionMoment& b, const Mat3& coupling,
                      LocalTerm<11>& out) {
  const EdgeFrame::Rotation turn_a = a.edge.rotation();
  const EdgeFrame::Rotation turn_b = b.edge.rotation();
  const Eigen::Vector4d force_a = turn_a.transpose() * a.moment;
  const Eigen::Vector4d force_b = turn_b.transpose() * b.moment;
  out.gradient << -force_a.head<3>(), force_a.head<3>() - force_b.head<3>(), force_b.head<3>(),
      force_a[3], force_b[3];
  if constexpr (D == Derivatives::Gradient) return;

  // By the vectors and angles of the edges, then by the nodes that these run between.
  const Eigen::Matrix4d aa =
      turn_a.transpose() * a.stiffness * turn_a + a.edge.geometric_stiffness(a.moment);
  const Eigen::Matrix4d bb =
      turn_b.transpose() * b.stiffness * turn_b + b.edge.geometric_stiffness(b.moment);
  const Eigen::Matrix4d ba = turn_b.transpose() * coupling * turn_a;
  auto& h = out.hessian;
  set_joint_blocks<Mat3>(aa.topLeftCorner<3, 3>(), ba.topLeftCorner<3, 3>(),
                         bb.topLeftCorner<3, 3>(), h);
  const Eigen::RowVector3d aa_te = aa.bottomLeftCorner<1, 3>();
  const Eigen::RowVector3d bb_te = bb.bottomLeftCorner<1, 3>();
  const Eigen::RowVector3d ba_te = ba.bottomLeftCorner<1, 3>();            // theta_b by e_a
  const Eigen::RowVector3d ab_te = ba.topRightCorner<3, 1>().transpose();  // theta_a by e_b
  h.block<1, 3>(9, 0) = -aa_te;
  h.block<1, 3>(9, 3) = aa_te - ab_te;
  h.block<1, 3>(9, 6) = ab_te;
  h.block<1, 3>(10, 0) = -ba_te;
  h.block<1, 3>(10, 3) = ba_te - bb_te;
  h.block<1, 3>(10, 6) = bb_te;
  h(9, 9) = aa(3, 3);
  h(10, 9) = ba(3, 3);
  h(10, 10) = bb(3, 3);
}

}  // namespace der
