#pragma once

#include <tuple>

#include "der/core/types.hpp"
#include "der/energies/edge_moment.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/vertex_response.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/cross_matrix.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/kinematics/held_frame.hpp"
#include "der/kinematics/natural_strain_offset.hpp"

namespace der {

/// Whole twist [rad] of a vertex whose reference twist at the start of the step was `reference`:
/// that of the two frames, which is known up to whole turns, next to what the angles make of it.
template <class T>
T whole_twist(const SectionFrameOf<T>& before, const SectionFrameOf<T>& after,
              const T& theta_before, const T& theta_after, const T& reference) {
  return nearest_turn(twist_between(before, after), theta_after - theta_before + reference);
}

/// The frame that the state follows for an edge (FrameBlock), as numbers of a kernel.
template <class T>
struct FollowedFrame {
  Vector3<T> tangent;   ///< of the source
  Vector3<T> director;  ///< there
  auto fields() { return std::tie(tangent, director); }

  [[nodiscard]] EdgeFrameOf<T> at(const Vector3<T>& vector, const T& theta) const {
    return {vector, theta, tangent, director};
  }
};
inline FollowedFrame<double> followed(const FrameBlock& block, const Vector& controls) {
  return {block.tangent(controls), block.director(controls)};
}

/// The vertex at this moment: its natural shape changes by actuations.
template <class AVertex>
AVertex actuated_vertex(AVertex vertex, const NaturalStrainOffset& shift, const Vector& controls) {
  const MaterialCurvature change = shift.strain(controls);
  vertex.rest.kappa_1 += change.kappa_1;
  vertex.rest.kappa_2 += change.kappa_2;
  vertex.rest.twist += change.twist;
  return vertex;
}

/// Bending about two axes and twist at a node between two edges (Bergou et al., Discrete Viscous
/// Threads, SIGGRAPH 2010, section 4.2, with the directors of half the twist; VertexKinematics).
/// Coordinates: the three nodes, then the angles of the two edges.
template <class Curvature, class AVertex = Vertex>
struct SpatialBend {
  static constexpr int kDofs = 11;
  static constexpr int kNodes = 3;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Constants {
    AVertex vertex;
    FrameBlock before;
    FrameBlock after;
    double glued = 0.0;  ///< [rad] by which the section after it is turned without strain
    NaturalStrainOffset actuated{};

    [[nodiscard]] bool is_actuated() const { return actuated.entry >= 0; }
    [[nodiscard]] AVertex actuated_vertex(const Vector& controls) const {
      return der::actuated_vertex(vertex, actuated, controls);
    }
  };

  template <class T>
  struct Values {
    typename AVertex::template In<T> vertex;
    FollowedFrame<T> before;
    FollowedFrame<T> after;
    T glued = 0.0;      ///< [rad]
    T reference = 0.0;  ///< reference twist [rad]
    auto fields() {
      return std::tuple_cat(vertex.fields(), before.fields(), after.fields(),
                            std::tie(glued, reference));
    }
  };
  static Values<double> values(const Constants& c, const Vector& controls) {
    return {c.actuated_vertex(controls), followed(c.before, controls), followed(c.after, controls),
            c.glued, controls[c.after.twist_at_start()]};
  }

  /// The frames of the two edges, that after a glued vertex turned back, and the whole twist
  /// between them [rad].
  template <class T>
  struct Frames {
    EdgeFrameOf<T> a;
    EdgeFrameOf<T> b;
    T twist;
  };
  template <class T>
  static Frames<T> frames(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x) {
    const auto node = [&](int i) { return x.template segment<3>(3 * i); };
    const EdgeFrameOf<T> a = c.before.at(node(1) - node(0), x[9]);
    const T theta_after = x[10] - c.glued;
    const EdgeFrameOf<T> b = c.after.at(node(2) - node(1), theta_after);
    return {a, b, whole_twist<T>(a.frame, b.frame, x[9], theta_after, c.reference)};
  }
  static Frames<double> frames(const Constants& c, const Vector& controls,
                               const Eigen::Matrix<double, kDofs, 1>& x) {
    return frames<double>(values(c, controls), x);
  }

  template <Derivatives D, class T>
  static void evaluate(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x,
                       LocalTerm<kDofs, T>& out) {
    const auto [a, b, twist] = frames<T>(c, x);
    const VertexKinematics<Curvature, T> kinematics(a.frame, b.frame, twist);
    if constexpr (D == Derivatives::Energy) {
      out.energy = kinematics.energy(c.vertex);
      return;
    }
    VertexResponseOf<T> response;
    kinematics.template respond<D == Derivatives::Hessian>(c.vertex, response);
    out.energy = response.energy;
    const Matrix3<T>& stiffness = response.stiffness;
    set_edge_moments<D, T>({a, -response.moment, stiffness}, {b, response.moment, stiffness},
                           -stiffness - 0.5 * cross_matrix<T>(response.moment), out);
  }
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    evaluate<D, double>(values(c, here.controls), x, out);
  }
};

/// The vertex of a corner.
using CornerBend = SpatialBend<AngleCurvature, CoupledVertex>;

/// Bending and twist of the cell between a held section and the edge next to it. Coordinates: the
/// two nodes, then the edge's angle. supports/clamp.hpp has the lengths of the cell.
template <class Curvature>
struct SpatialClamp {
  static constexpr int kDofs = 7;
  static constexpr int kNodes = 2;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;
  struct Constants {
    Vertex vertex;
    HeldFrame held;
    FrameBlock edge;
    double side = 1.0;  ///< +1: the edge leaves the clamp, -1: it arrives there
    NaturalStrainOffset actuated{};
    bool holds_section = true;  ///< against turning about the tangent

    [[nodiscard]] Vertex actuated_vertex(const Vector& controls) const {
      return der::actuated_vertex(vertex, actuated, controls);
    }
  };

  template <class T>
  struct Values {
    VertexOf<T> vertex;
    SectionFrameOf<T> held;
    T turned = 0.0;  ///< of the held section about its tangent [rad]
    FollowedFrame<T> edge;
    T reference = 0.0;  ///< reference twist [rad]
    // The same in all lanes.
    T side = 1.0;
    T holds_section = 1.0;  ///< 0: it does not
    auto fields() {
      return std::tuple_cat(vertex.fields(), held.fields(), edge.fields(),
                            std::tie(turned, reference, side, holds_section));
    }
    [[nodiscard]] bool leaves() const { return LaneTraits<T>::lane(side, 0) > 0.0; }
  };
  static Values<double> values(const Constants& c, const Vector& controls) {
    const double turned = c.held.twist_angle(controls);
    return {c.actuated_vertex(controls),
            c.held.untwisted(controls).turned(turned),
            turned,
            followed(c.edge, controls),
            controls[c.side > 0.0 ? c.edge.twist_at_start() : c.edge.twist_at_end()],
            c.side,
            c.holds_section ? 1.0 : 0.0};
  }

  /// The edge, the frames before and after the cell, one of which is the edge's, and the whole
  /// twist between them [rad].
  template <class T>
  struct Frames {
    EdgeFrameOf<T> edge;
    SectionFrameOf<T> a;
    SectionFrameOf<T> b;
    T twist;
  };
  template <class T>
  static Frames<T> frames(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x) {
    const EdgeFrameOf<T> edge =
        c.edge.at(x.template segment<3>(3) - x.template segment<3>(0), x[6]);
    if (c.leaves()) {
      return {edge, c.held, edge.frame,
              whole_twist<T>(c.held, edge.frame, c.turned, x[6], c.reference)};
    }
    return {edge, edge.frame, c.held,
            whole_twist<T>(edge.frame, c.held, x[6], c.turned, c.reference)};
  }
  static Frames<double> frames(const Constants& c, const Vector& controls,
                               const Eigen::Matrix<double, kDofs, 1>& x) {
    return frames<double>(values(c, controls), x);
  }

  template <class T>
  static VertexKinematics<Curvature, T> kinematics(const Values<T>& c, const Frames<T>& frames) {
    const auto& [edge, a, b, twist] = frames;
    if (LaneTraits<T>::lane(c.holds_section, 0) > 0.0) return {a, b, twist};
    const FreeSide side = c.leaves() ? FreeSide::Before : FreeSide::After;
    return VertexKinematics<Curvature, T>::with_free_side(side, a, b, twist, c.vertex.rest.twist);
  }
  static VertexKinematics<Curvature> kinematics(const Constants& c, const Vector& controls,
                                                const Frames<double>& frames) {
    return kinematics<double>(values(c, controls), frames);
  }

  template <Derivatives D, class T>
  static void evaluate(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x,
                       LocalTerm<kDofs, T>& out) {
    const Frames<T> here = frames<T>(c, x);
    const VertexKinematics<Curvature, T> seen = kinematics<T>(c, here);
    if constexpr (D == Derivatives::Energy) {
      out.energy = seen.energy(c.vertex);
      return;
    }
    VertexResponseOf<T> response;
    seen.template respond<D == Derivatives::Hessian>(c.vertex, response);
    out.energy = response.energy;
    set_edge_moment<D, T>(here.edge, c.side * response.moment, response.stiffness, out);
  }
  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    evaluate<D, double>(values(c, here.controls), x, out);
  }
};

}  // namespace der
