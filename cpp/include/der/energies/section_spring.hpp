#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "der/core/types.hpp"
#include "der/energies/edge_moments.hpp"
#include "der/energies/held_section.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/kinematics/held_frame.hpp"
#include "der/kinematics/natural_strain_offset.hpp"

namespace der {

/// RotationalSpring in space: springs against turning in series with the rod between them and the
/// edges (HeldSection), whose sections are those at the springs as each edge, and a clamp beside
/// them, would carry them. supports/section_spring.hpp says how the section of a rod at a place is
/// a weighted sum of these. Coordinates: the nodes, then the angles.
template <int Edges>
struct SectionSpring {
  static_assert(Edges == 1 || Edges == 2);
  static constexpr int kNodes = Edges + 1;
  static constexpr int kDofs = 3 * kNodes + Edges;
  static constexpr EnergyTerm kTerm = EnergyTerm::Spring;
  struct HeldEdge {
    FrameBlock block;
    SpatialPivot first;  ///< of the edge, beside a clamp
    SpatialPivot last;
    /// The section that the edge carries, by its directors and its tangent in the edge's own. It is
    /// the drawn one where the springs exert no moment.
    Mat3 carried = Mat3::Identity();
    /// Control: twist [rad] from the edge's reference director to the drawn section, whole turns
    /// included; -1: they do not count.
    Index reference_twist = -1;
    Mat3 weights = Mat3::Identity();  ///< W_i [-]
  };
  /// How the state counts the twist from the first of the two carried sections to the other.
  struct TwistBetween {
    Index reference = -1;  ///< control: reference twist of the vertex between them [rad]
    double side = 1.0;     ///< -1 where the vertex leads from the second to the first
    double drawn = 0.0;    ///< what the angles and that control make in the drawn shape [rad]
  };
  /// The section that a clamp holds. It has the rest of the weights.
  struct HeldBeside {
    HeldFrame held;
    Mat3 carried = Mat3::Identity();  ///< as that of an edge
    bool holds_section = true;        ///< against turning about the tangent, too
  };
  struct Constants {
    SpringInSeries spring;
    std::array<HeldEdge, Edges> edges;
    std::optional<HeldBeside> clamp;  ///< beside the place on one edge
    NaturalStrainOffset
        actuated;          ///< how far actuations turn the section beyond those that are carried
    TwistBetween between;  ///< where there are no springs, of two carried sections
  };

  /// The section that turns with an edge, and therefore by the same rotation.
  static SectionFrame carried_by(const SectionFrame& edge, const Mat3& section) {
    Mat3 axes;
    axes << edge.first, edge.second, edge.tangent;
    const Mat3 carried = axes * section;
    return {carried.col(2), carried.col(0), carried.col(1)};
  }

  /// The rotation of a carried section by actuations, in its axes (the directors and the tangent).
  struct ActuatedRotation {
    Mat3 turn = Mat3::Identity();
    Mat3 by_strains = Mat3::Zero();  ///< rotation of the turned section by the strains, in its axes

    ActuatedRotation(const Constants& c, const Vector& controls) {
      const MaterialCurvature strain = c.actuated.strain(controls);
      // Bending towards a director turns about the other one.
      Mat3 about;
      about << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
      const Vec3 vector = about * Vec3(strain.kappa_1, strain.kappa_2, strain.twist);
      const double angle = vector.norm();
      by_strains = about;
      if (angle == 0.0) return;
      const Mat3 across = cross_matrix(Vec3(vector / angle));
      const double sine = std::sin(angle);
      const double versine = 1.0 - std::cos(angle);
      turn += sine * across + versine * across * across;
      by_strains =
          (Mat3::Identity() - versine / angle * across + (1.0 - sine / angle) * across * across) *
          about;
    }
  };

  using EdgeFrames = std::array<EdgeFrame, Edges>;
  /// The edges, the sections beside the springs, and theirs.
  struct Response {
    EdgeFrames edges;
    std::size_t count;  ///< of carried sections: those of the edges, and that of a clamp
    HeldSection::CarriedSections carried;
    HeldSection held;

    Response(const Constants& c, const Configuration& here,
             const Eigen::Matrix<double, kDofs, 1>& x)
        : edges(edge_frames(c, here, x)),
          count(c.clamp ? 2 : Edges),
          carried(carried_sections(c, edges, here, x)),
          held(c.spring, carried, count) {}
    // `held` refers to `carried`.
    Response(const Response&) = delete;
    Response& operator=(const Response&) = delete;
    Response(Response&&) = delete;
    Response& operator=(Response&&) = delete;
    ~Response() = default;
  };

  /// The derivative of the energy by the strains of `actuated` [N m]: all that is carried turns.
  static Vec3 by_actuated(const Constants& c, const Configuration& here,
                          const Eigen::Matrix<double, kDofs, 1>& x) {
    const Response response(c, here, x);
    const Mat3 by_strains = ActuatedRotation(c, here.controls).by_strains;
    Vec3 result = Vec3::Zero();
    for (std::size_t i = 0; i < response.count; ++i) {
      const SectionFrame& section = response.carried[i].frame;
      Mat3 axes;
      axes << section.first, section.second, section.tangent;
      result += by_strains.transpose() * (axes.transpose() * response.held.moment(i));
    }
    return result;
  }

  /// The part of the energy [J] that the rod on the way to the springs stores.
  static double stored_on_the_way(const Constants& c, const Configuration& here,
                                  const Eigen::Matrix<double, kDofs, 1>& x) {
    return Response(c, here, x).held.energy_on_the_way();
  }

  /// The moments that the springs exert on their edges, and their sum, of which a clamp may have a
  /// part.
  static EdgeMoments moments(const Constants& c, const Configuration& here,
                             const Eigen::Matrix<double, kDofs, 1>& x) {
    const Response response(c, here, x);
    EdgeMoments result;
    for (std::size_t i = 0; i < response.count; ++i) {
      const Vec3 moment = -response.held.moment(i);
      result.whole += moment;
      if (i < Edges) result.on_edge[i] = moment;
    }
    return result;
  }

  /// HeldSection::axes_of_springs, without moments on the section.
  static Mat3 axes_of_springs(const Constants& c, const Configuration& here,
                              const Eigen::Matrix<double, kDofs, 1>& x) {
    return Response(c, here, x).held.axes_of_springs();
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    const Response response(c, here, x);
    out.energy = response.held.energy();
    if constexpr (D == Derivatives::Energy) return;

    std::array<EdgeFrame::Rotation, Edges> maps;
    out.gradient.setZero();
    for (int i = 0; i < Edges; ++i) {
      maps[std::size_t(i)] = response.edges[std::size_t(i)].rotation();
      const Eigen::Vector4d force =
          maps[std::size_t(i)].transpose() * response.held.moment(std::size_t(i));
      out.gradient.template segment<3>(3 * i) -= force.head<3>();
      out.gradient.template segment<3>(3 * i + 3) += force.head<3>();
      out.gradient[3 * kNodes + i] = force[3];
    }
    if constexpr (D == Derivatives::Gradient) return;

    const HeldSection::Stiffness stiffness = response.held.stiffness();
    out.hessian.setZero();
    for (std::size_t i = 0; i < Edges; ++i) {
      for (std::size_t j = 0; j < Edges; ++j) {
        Eigen::Matrix4d block = maps[i].transpose() * stiffness[i][j] * maps[j];
        if (i == j) block += response.edges[i].geometric_stiffness(response.held.moment(i));
        add_block(int(i), int(j), block, out.hessian);
      }
    }
  }

 private:
  /// Without springs the twist from a drawn section does not count, but that between the two
  /// carried sections does.
  static double twist_from_first(const Constants& c, const Configuration& here,
                                 const Eigen::Matrix<double, kDofs, 1>& x,
                                 const HeldSection::CarriedSections& carried) {
    const double second = c.clamp ? c.clamp->held.twist_angle(here.controls) : x[kDofs - 1];
    const double near = second - x[3 * kNodes] +
                        c.between.side * here.controls[c.between.reference] - c.between.drawn;
    return nearest_turn(twist_between(carried[0].frame, carried[1].frame), near);
  }

  static HeldSection::CarriedSections carried_sections(const Constants& c, const EdgeFrames& frames,
                                                       const Configuration& here,
                                                       const Eigen::Matrix<double, kDofs, 1>& x) {
    HeldSection::CarriedSections carried;
    const ActuatedRotation actuated(c, here.controls);
    double turned = 0.0;
    if (c.clamp) {
      turned = c.clamp->held.twist_angle(here.controls);
      const SectionFrame section = carried_by(c.clamp->held.untwisted(here.controls).turned(turned),
                                              c.clamp->carried * actuated.turn);
      carried[1] = {section, nearest_turn(twist_between(c.spring.drawn, section), turned),
                    Mat3::Identity() - c.edges[0].weights};
    }
    for (int i = 0; i < Edges; ++i) {
      const HeldEdge& edge = c.edges[std::size_t(i)];
      const SectionFrame section =
          carried_by(frames[std::size_t(i)].frame, edge.carried * actuated.turn);
      const double near = edge.reference_twist < 0
                              ? turned
                              : x[3 * kNodes + i] - here.controls[edge.reference_twist];
      const double twist = nearest_turn(twist_between(c.spring.drawn, section), near);
      carried[std::size_t(i)] = {section, twist, edge.weights};
    }
    if (c.between.reference >= 0) {
      carried[1].twist = carried[0].twist + twist_from_first(c, here, x, carried);
    }
    return carried;
  }

  static EdgeFrames edge_frames(const Constants& c, const Configuration& here,
                                const Eigen::Matrix<double, kDofs, 1>& x) {
    return edge_frames(c, here, x, std::make_index_sequence<Edges>{});
  }
  template <std::size_t... i>
  static EdgeFrames edge_frames(const Constants& c, const Configuration& here,
                                const Eigen::Matrix<double, kDofs, 1>& x,
                                std::index_sequence<i...> /*edges*/) {
    return {{edge_frame(c.edges[i], here.controls, x, int(i))...}};
  }
  static EdgeFrame edge_frame(const HeldEdge& edge, const Vector& values,
                              const Eigen::Matrix<double, kDofs, 1>& x, int i) {
    const Vec3 vector = x.template segment<3>(3 * i + 3) + edge.last.offset(values) -
                        x.template segment<3>(3 * i) - edge.first.offset(values);
    return {vector, x[3 * kNodes + i], edge.block.tangent(values), edge.block.director(values)};
  }

  /// Adds a block by the vectors and angles of edges i and j.
  static void add_block(int i, int j, const Eigen::Matrix4d& block,
                        Eigen::Matrix<double, kDofs, kDofs>& hessian) {
    const Mat3 ee = block.topLeftCorner<3, 3>();
    const int angle_i = 3 * kNodes + i;
    const int angle_j = 3 * kNodes + j;
    for (const int p : {0, 1}) {
      const double side_p = p == 0 ? -1.0 : 1.0;
      for (const int q : {0, 1}) {
        hessian.template block<3, 3>(3 * (i + p), 3 * (j + q)) +=
            (side_p * (q == 0 ? -1.0 : 1.0)) * ee;
      }
      hessian.template block<3, 1>(3 * (i + p), angle_j) += side_p * block.topRightCorner<3, 1>();
      hessian.template block<1, 3>(angle_i, 3 * (j + p)) += side_p * block.bottomLeftCorner<1, 3>();
    }
    hessian(angle_i, angle_j) += block(3, 3);
  }
};

}  // namespace der
