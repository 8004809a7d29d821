#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "der/core/types.hpp"
#include "der/energies/circulatory_term.hpp"
#include "der/energies/edge_moments.hpp"
#include "der/energies/effective_edge.hpp"
#include "der/energies/framed_edge.hpp"
#include "der/energies/held_force.hpp"
#include "der/energies/held_moment.hpp"
#include "der/energies/load_amount.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/joint_turn.hpp"

namespace der {

struct ElementLists;  // energies/registry.hpp

// Circulatory loads (Ziegler, Principles of Structural Stability, 1968): they depend on the shape
// alone, but their work depends on the way that leads there, so that they have no potential and
// their tangent is not symmetric. A force that turns with the rod is one, and in space every
// moment, one of a fixed direction too.
//
// Such a load knows the degrees of freedom u by a few local coordinates q only, dq = B' du with a
// constant B: the point on which it acts, the vectors of one or two edges and their angles. It does
// the work Q(q) . dq. Forces on u are therefore B Q, and their tangent B (dQ/dq) B' has a low rank
// (solvers/low_rank.hpp).

/// The weights of one or two edges in the bending of a vector that turns with `weights` of them:
/// beyond the middle of an outermost edge, whose weight is above 1, its turn against the next one
/// is more than that of the rod.
std::array<double, 2> weights_in_bending(const std::array<double, 2>& weights);
/// The same with the number of the edge that is outermost, on both sides of its middle.
std::array<double, 2> turn_of_outermost_edge(const std::array<double, 2>& weights,
                                             std::size_t outermost);

/// A force that turns with a planar rod, along sum d_i R_i F0 and as large as F0: R_i is the
/// rotation of an edge from its drawn direction, d_i are weights of the one or two edges. Local
/// coordinates: the point on which it acts, then the vectors of the edges.
struct PlanarFollowerForce {
  struct FollowedEdge {
    EffectiveEdge edge;
    double weight = 1.0;        ///< d_i, in bending [-]
    Vec2 drawn = Vec2::Zero();  ///< unit vector along the edge as it is drawn
  };
  std::vector<FollowedEdge> edges;
  /// Share of the edges' turn that springs at the place and a clamp beside it leave the tangent.
  double share = 1.0;
  Index clamp_turn = -1;  ///< control: how far that clamp has turned [rad]; -1: it does not
  /// Share of the clamp's turn that the tangent would have if the edges had none of theirs left.
  double held_share = 1.0;

  [[nodiscard]] Index size() const { return 2 + 2 * static_cast<Index>(edges.size()); }
  /// `amount` is F0 [N].
  void evaluate(const Configuration& here, const Vec3& amount, CirculatoryTerm& out) const;

 private:
  /// Turns the force back, by less than half a turn, to `share` of its turn from `held`: F0, turned
  /// with the clamp.
  void hold_back(const Vec2& held, CirculatoryTerm& out) const;
};

/// A force that turns with a joint in a plane: R(theta) F0, theta the rotation of the joint. Local
/// coordinates: the point on which it acts, then theta.
struct JointFollowerForce {
  Index rotation = 0;  ///< degree of freedom

  [[nodiscard]] static Index size() { return 3; }
  /// `amount` is F0 [N].
  void evaluate(const Configuration& here, const Vec3& amount, CirculatoryTerm& out) const;
};

/// A force that turns with a joint in space: R F0 with the rotation R of the joint. Local
/// coordinates: the point on which it acts, then the three of the joint.
struct SpatialJointFollowerForce {
  Index rotation = 0;  ///< first degree of freedom
  JointBlock joint;

  [[nodiscard]] static Index size() { return 6; }
  /// `amount` is F0 [N].
  void evaluate(const Configuration& here, const Vec3& amount, CirculatoryTerm& out) const;
};

/// A moment M on a joint in space, fixed in space or turning with it, then R M0: it does the work
/// M . omega. Local coordinates: the three of the joint.
struct JointMoment {
  Index rotation = 0;  ///< first degree of freedom
  JointBlock joint;
  bool follower = false;

  [[nodiscard]] static Index size() { return 3; }
  /// `amount` is M, or M0 [N m].
  void evaluate(const Configuration& here, const Vec3& amount, CirculatoryTerm& out) const;
};

/// A force that turns with a rod in space: PlanarFollowerForce with the rotations of section
/// frames. Local coordinates: the point, then the vector and the angle of each edge.
struct FollowerForce {
  struct FollowedEdge : FramedEdge {
    double weight = 1.0;  ///< d_i [-]
  };
  std::vector<FollowedEdge> edges;

  [[nodiscard]] Index size() const { return 3 + 4 * static_cast<Index>(edges.size()); }
  /// `amount` is F0 [N].
  void evaluate(const Configuration& here, const Vec3& amount, CirculatoryTerm& out) const;
};

/// A moment M on a rod in space, fixed in space or turning with the rod, then along sum d_i R_i M0
/// and as large as M0. Edge i takes the part across_i of M across the tangent t, and the part
/// along_i along it:
///   N_i = across_i M + (along_i - across_i) (M . t) t,   with the work sum N_i . omega_i,
/// t being that of the edge with the larger part along it. The two weights differ beyond the middle
/// of an outermost edge (model/section_place.hpp). Each of them adds up to 1, so that the whole is
/// M. Local coordinates: the vector and the angle of each edge.
///
/// Under M the section at its place turns further than the edges tell, by c M with c = `compliance`
/// in the axes of the drawn section, since the rod between them bends and twists. So the moment
/// that turns with the section is along that sum of M0 + c M0 x M0, to the same order, unless its
/// place lies where the weights d_i extrapolate.
struct SpatialMoment {
  struct TurnedEdge : FramedEdge {
    double weight = 1.0;  ///< d_i [-]
    double across = 1.0;  ///< [-]
    double along = 1.0;   ///< [-]
  };
  std::vector<TurnedEdge> edges;
  bool follower = false;
  bool turns_further = false;      ///< whether c counts in the direction of one that turns
  Mat3 compliance = Mat3::Zero();  ///< c [rad/(N m)]

  [[nodiscard]] Index size() const { return 4 * static_cast<Index>(edges.size()); }
  /// The number in `edges` of that which is nearer.
  [[nodiscard]] std::size_t nearer() const { return edges.front().across < 0.5 ? 1 : 0; }
  /// `amount` is M, or M0 [N m], here and below.
  [[nodiscard]] EdgeMoments moments_at(const Configuration& here, const Vec3& amount) const;
  void evaluate(const Configuration& here, const Vec3& amount, CirculatoryTerm& out) const;
  /// 1/2 M . c M.
  [[nodiscard]] StoredBeside stored(const Configuration& here, const Vec3& amount) const;
};

/// One load: what it is, how large, and on which degrees of freedom it acts.
struct CirculatoryLoad {
  /// weight * u[dof] is a term of a local coordinate.
  struct Term {
    Index dof = 0;
    double weight = 1.0;
  };

  std::variant<PlanarFollowerForce, JointFollowerForce, SpatialJointFollowerForce, FollowerForce,
               HeldForce<1>, HeldForce<2>, SpatialMoment, HeldMoment<1>, HeldMoment<2>, JointMoment>
      kind;
  LoadAmount amount;
  std::vector<std::vector<Term>> coordinates;  ///< the rows of B'

  void evaluate(const Configuration& here, CirculatoryTerm& out) const;
  /// The whole force [N]; zero for a moment.
  [[nodiscard]] Vec3 force(const Configuration& here) const;
  /// The whole moment [N m], and the parts of its edges; zero for a force.
  [[nodiscard]] EdgeMoments moments(const Configuration& here) const;
  /// The change [N m] of the moment that springs against turning exert at the place of a moment.
  [[nodiscard]] Vec3 taken_by_springs(const Configuration& here) const;
  /// HeldMoment::axes_of_springs; none where no springs are at the place.
  [[nodiscard]] std::optional<Mat3> axes_of_springs(const Configuration& here) const;
  /// The edges that a moment turns, whose vectors and angles are its coordinates; null beyond their
  /// number.
  [[nodiscard]] std::array<const FramedEdge*, 2> turned_edges() const;
  /// The one of them that is nearer to its place.
  [[nodiscard]] const FramedEdge& nearer_edge() const;
  /// Zero for a force.
  [[nodiscard]] StoredBeside stored(const Configuration& here) const;
};

/// Those of a model. Files that use no other elements include this header alone, so that a new
/// kernel does not recompile them.
std::vector<CirculatoryLoad>& circulatory_loads(ElementLists& elements);
const std::vector<CirculatoryLoad>& circulatory_loads(const ElementLists& elements);

/// Whether forces are the gradient of a potential, so that the tangent is symmetric.
inline bool has_potential(const ElementLists& elements) {
  return circulatory_loads(elements).empty();
}

/// Adds `factor` times the forces of the loads to `total`, over all degrees of freedom.
void add_circulatory_forces(const std::vector<CirculatoryLoad>& loads, const Configuration& here,
                            double factor, Vector& total);

/// Work [J] of the loads along a displacement of all degrees of freedom.
double circulatory_work(const std::vector<CirculatoryLoad>& loads, const Configuration& here,
                        const Vector& displacement);

}  // namespace der
