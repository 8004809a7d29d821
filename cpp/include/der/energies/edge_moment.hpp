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

}  // namespace der
