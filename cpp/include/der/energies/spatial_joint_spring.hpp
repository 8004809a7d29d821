#pragma once

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/vertex_response.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/joint_turn.hpp"

namespace der {

/// A rotational spring on a joint in space: E = 1/2 (k1 s1^2 + k2 s2^2 + kt twist^2) of the strains
/// between the section of the spring's rod as drawn and as the joint has turned it, the same as
/// those between two edges. The joint turns by less than half a turn.
struct SpatialJointSpring {
  static constexpr int kNodes = 0;
  static constexpr int kJoints = 3;  ///< coordinates of joints
  static constexpr int kDofs = 3;
  static constexpr EnergyTerm kTerm = EnergyTerm::Spring;
  struct Constants {
    Vec3 stiffness = Vec3::Zero();  ///< towards the two directors, about the tangent [N m/rad]
    JointSection section;
  };

  /// The derivatives of the energy by the rotation of the joint.
  template <bool with_stiffness>
  static VertexResponse respond(const Constants& c, const JointTurn& turn) {
    const SectionFrame now = turn.section(c.section.drawn);
    const Vertex vertex{c.stiffness[0], c.stiffness[1], c.stiffness[2], {}};
    VertexResponse response;
    VertexKinematics<AngleCurvature>(c.section.drawn, now, twist_between(c.section.drawn, now))
        .template respond<with_stiffness>(vertex, response);
    return response;
  }
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here, const Vec3& x,
                       LocalTerm<kDofs>& out) {
    const JointTurn turn(c.section.joint, here.controls, x);
    const VertexResponse response = respond<D == Derivatives::Hessian>(c, turn);
    out.energy = response.energy;
    if constexpr (D == Derivatives::Energy) return;
    const Mat3 spin = turn.spin();
    out.gradient = spin.transpose() * response.moment;
    if constexpr (D == Derivatives::Gradient) return;
    out.hessian =
        spin.transpose() * response.stiffness * spin + turn.geometric_stiffness(response.moment);
  }
};

}  // namespace der
