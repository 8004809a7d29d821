#pragma once

#include <cmath>

#include "der/core/types.hpp"
#include "der/energies/edge_moment.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/turn_from_plane.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/kinematics/frame_block.hpp"

namespace der {

/// Twist of the half edge between a fork and the middle of its edge: E = 1/2 GJ psi^2 / (l/2). A
/// fork stands in the x-y plane; it holds the section of a rod against turning about the rod's
/// tangent there, t, and lets it tilt. psi is the sine of the turn of the edge's section about t
/// (TurnFromPlane).
///
/// About the edge's own direction, which is turned by kappa l/2 from t, it would hold a part of the
/// tilt as well: an error of order 1. Coordinates: the two nodes, then the edge's angle.
struct Fork {
  static constexpr int kDofs = 7;
  static constexpr int kNodes = 2;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Constants {
    double stiffness = 0.0;        ///< GJ over the half edge [N m]
    Vec2 upright = Vec2::UnitX();  ///< components of v towards the two directors
    FrameBlock edge;
    Index direction = -1;  ///< control: angle of t from the x axis [rad]
  };

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    const EdgeFrame edge(x.segment<3>(3) - x.segment<3>(0), x[6], c.edge.tangent(here.controls),
                         c.edge.director(here.controls));
    const double angle = here.controls[c.direction];
    const TurnFromPlane turn(edge.frame, c.upright, {std::cos(angle), std::sin(angle)});
    out.energy = 0.5 * c.stiffness * turn.psi * turn.psi;
    if constexpr (D == Derivatives::Energy) return;
    set_edge_moment<D, double>(edge, c.stiffness * turn.psi * turn.axis,
                               turn.stiffness(c.stiffness, turn.psi), out);
  }
};

}  // namespace der
