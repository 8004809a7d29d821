#pragma once

#include "der/core/types.hpp"
#include "der/energies/edge_moment.hpp"
#include "der/energies/joint_response.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/kinematics/rest_shift.hpp"

namespace der {

/// [v]x, the matrix of the cross product with v.
template <class T>
Matrix3<T> cross_matrix(const Vector3<T>& v) {
  Matrix3<T> m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Whole twist [rad] of a joint whose reference twist at the start of the step was `reference`:
/// that of the two frames, which is known up to whole turns, next to what the angles make of it.
template <class T>
T whole_twist(const SectionFrameOf<T>& before, const SectionFrameOf<T>& after,
              const T& theta_before, const T& theta_after, const T& reference) {
  return nearest_turn(twist_between(before, after), theta_after - theta_before + reference);
}

/// The joint at this moment: its natural shape changes by actuations.
template <class AJoint>
AJoint actuated_joint(AJoint joint, const RestShift& shift, const Vector& controls) {
  const JointStrain change = shift.strain(controls);
  joint.rest.kappa_1 += change.kappa_1;
  joint.rest.kappa_2 += change.kappa_2;
  joint.rest.twist += change.twist;
  return joint;
}

/// Bending about two axes and twist at a node between two edges (Bergou et al., Discrete Viscous
/// Threads, SIGGRAPH 2010, section 4.2, with the directors of half the twist; JointKinematics).
/// Coordinates: the three nodes, then the angles of the two edges.
template <class Curvature, class AJoint = Joint>
struct SpatialBend {
  static constexpr int kDofs = 11;
  static constexpr int kNodes = 3;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Constants {
    AJoint joint;
    FrameBlock before;
    FrameBlock after;
    double glued = 0.0;  ///< [rad] by which the section after it is turned without strain
    RestShift actuated{};

    [[nodiscard]] bool is_actuated() const { return actuated.entry >= 0; }
    [[nodiscard]] AJoint actuated_joint(const Vector& controls) const {
      return der::actuated_joint(joint, actuated, controls);
    }
  };

  /// The frames of the two edges, that after a glued joint turned back, and the whole twist between
  /// them [rad].
  struct Frames {
    EdgeFrame a;
    EdgeFrame b;
    double twist;
  };
  static Frames frames(const Constants& c, const Vector& values,
                       const Eigen::Matrix<double, kDofs, 1>& x) {
    const EdgeFrame a(x.segment<3>(3) - x.segment<3>(0), x[9], c.before.tangent(values),
                      c.before.director(values));
    const double theta_after = x[10] - c.glued;
    const EdgeFrame b(x.segment<3>(6) - x.segment<3>(3), theta_after, c.after.tangent(values),
                      c.after.director(values));
    return {a, b,
            whole_twist(a.frame, b.frame, x[9], theta_after, values[c.after.twist_at_start()])};
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    const auto [a, b, twist] = frames(c, here.controls, x);
    const JointKinematics<Curvature> kinematics(a.frame, b.frame, twist);
    const AJoint joint = c.actuated_joint(here.controls);
    if constexpr (D == Derivatives::Energy) {
      out.energy = kinematics.energy(joint);
      return;
    }
    JointResponse response;
    kinematics.template respond<D == Derivatives::Hessian>(joint, response);
    out.energy = response.energy;
    const Mat3& stiffness = response.stiffness;
    set_edge_moments<D>({a, -response.moment, stiffness}, {b, response.moment, stiffness},
                        -stiffness - 0.5 * cross_matrix(response.moment), out);
  }
};

/// The joint of a corner.
using CornerBend = SpatialBend<AngleCurvature, CoupledJoint>;

/// Bending and twist of the cell between a held section and the edge next to it. Coordinates: the
/// two nodes, then the edge's angle. supports/clamp.hpp has the lengths of the cell.
template <class Curvature>
struct SpatialClamp {
  static constexpr int kDofs = 7;
  static constexpr int kNodes = 2;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Constants {
    Joint joint;
    HeldFrame held;
    FrameBlock edge;
    double side = 1.0;  ///< +1: the edge leaves the clamp, -1: it arrives there
    RestShift actuated{};
    bool holds_section = true;  ///< against turning about the tangent

    [[nodiscard]] Joint actuated_joint(const Vector& controls) const {
      return der::actuated_joint(joint, actuated, controls);
    }
  };

  /// The edge, the frames before and after the cell, one of which is the edge's, and the whole
  /// twist between them [rad].
  struct Frames {
    EdgeFrame edge;
    SectionFrame a;
    SectionFrame b;
    double twist;
  };
  static Frames frames(const Constants& c, const Vector& values,
                       const Eigen::Matrix<double, kDofs, 1>& x) {
    const EdgeFrame edge(x.segment<3>(3) - x.segment<3>(0), x[6], c.edge.tangent(values),
                         c.edge.director(values));
    const double turned = c.held.twist_angle(values);
    const SectionFrame held = c.held.untwisted(values).turned(turned);
    if (c.side > 0.0) {
      return {edge, held, edge.frame,
              whole_twist(held, edge.frame, turned, x[6], values[c.edge.twist_at_start()])};
    }
    return {edge, edge.frame, held,
            whole_twist(edge.frame, held, x[6], turned, values[c.edge.twist_at_end()])};
  }

  static JointKinematics<Curvature> kinematics(const Constants& c, const Vector& values,
                                               const Frames& frames) {
    const auto& [edge, a, b, twist] = frames;
    if (c.holds_section) return {a, b, twist};
    const FreeSide side = c.side > 0.0 ? FreeSide::Before : FreeSide::After;
    return JointKinematics<Curvature>::with_free_side(side, a, b, twist,
                                                      c.actuated_joint(values).rest.twist);
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    const Frames here_frames = frames(c, here.controls, x);
    const JointKinematics<Curvature> seen = kinematics(c, here.controls, here_frames);
    const Joint joint = c.actuated_joint(here.controls);
    if constexpr (D == Derivatives::Energy) {
      out.energy = seen.energy(joint);
      return;
    }
    JointResponse response;
    seen.template respond<D == Derivatives::Hessian>(joint, response);
    out.energy = response.energy;
    set_edge_moment<D>(here_frames.edge, c.side * response.moment, response.stiffness, out);
  }
};

}  // namespace der
