#pragma once

#include <Eigen/Geometry>

#include "der/core/types.hpp"
#include "der/energies/edge_moment.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/turn_from_plane.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/kinematics/frame_block.hpp"

namespace der {

/// A fork at a corner of the drawn rod holds the section there against turning about the mean t of
/// the tangents on its two sides, as one in the middle of a round does, however small that is. The
/// vertex of the corner has none of this: at its least energy the section turns by
///   omega_c = (K_a + K_b)^-1 (K_a omega_a + K_b omega_b)
/// with the stiffnesses K of the half edges beside it, and by t . omega_c = 0 this energy grows by
/// E = 1/2 k psi^2, psi = p_a . omega_a + p_b . omega_b = t . omega_c, p_i = K_i (K_a + K_b)^-1 t,
/// k = 1/(t . (K_a + K_b)^-1 t). Turns are those of TurnFromPlane.
///
/// t is of order 2. The p_i turn with it, and so lie to the edges as drawn to order 1 alone. That
/// suffices: p_a + p_b = t remains, and omega_b - omega_a and psi are as small as the edges are
/// short. Coordinates: the three nodes, then the angles of the two edges.
struct CornerFork {
  static constexpr int kDofs = 11;
  static constexpr int kNodes = 3;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Side {
    Vec2 upright = Vec2::UnitX();  ///< as in Fork
    Vec2 about = Vec2::UnitX();    ///< p_i [-], its components along t and z x t
    FrameBlock edge;
  };
  struct Constants {
    double stiffness = 0.0;  ///< k [N m]
    Side before;
    Side after;
    Index direction = -1;  ///< control: angle of t from the x axis [rad]
  };

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    const auto edge_of = [&](const Side& side, int node, double theta) {
      return EdgeFrame(x.segment<3>(3 * node + 3) - x.segment<3>(3 * node), theta,
                       side.edge.tangent(here.controls), side.edge.director(here.controls));
    };
    const EdgeFrame a = edge_of(c.before, 0, x[9]);
    const EdgeFrame b = edge_of(c.after, 1, x[10]);
    const Eigen::Rotation2Dd turned(here.controls[c.direction]);
    const TurnFromPlane of_a(a.frame, c.before.upright, turned * c.before.about);
    const TurnFromPlane of_b(b.frame, c.after.upright, turned * c.after.about);
    const double psi = of_a.psi + of_b.psi;
    out.energy = 0.5 * c.stiffness * psi * psi;
    if constexpr (D == Derivatives::Energy) return;
    const double torque = c.stiffness * psi;
    set_edge_moments<D, double>({a, torque * of_a.axis, of_a.stiffness(c.stiffness, psi)},
                                {b, torque * of_b.axis, of_b.stiffness(c.stiffness, psi)},
                                c.stiffness * of_b.axis * of_a.axis.transpose(), out);
  }
};

}  // namespace der
