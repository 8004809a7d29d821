#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "der/core/types.hpp"
#include "der/energies/edge_moments.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/kinematics/held_frame.hpp"

namespace der {

/// RotationalSpring in space: E = 1/2 r . K r with r = sum_i W_i kappa_i, and kappa_i the
/// rotation of edge i from its drawn place, as a joint between the drawn section at the spring and
/// the same section, carried by the edge, would measure it (JointKinematics): towards the first
/// director, towards the second, and the twist about the tangent, whole turns included. The weights
/// of two edges add up to the unit matrix; supports/section_spring.hpp says how the section of a
/// rod at a place is such a sum. Both are diagonal but at corners. Coordinates: the nodes, then the
/// angles.
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
    SectionFrame drawn;  ///< of the rod, at the spring
    /// The section that the edge carries, by its directors and its tangent in the edge's own. It is
    /// the drawn one where the spring exerts no moment.
    Mat3 carried = Mat3::Identity();
    /// Control: twist [rad] from the edge's reference director to the drawn section, whole turns
    /// included; -1: they do not count.
    Index reference_twist = -1;
    Mat3 weights = Mat3::Identity();  ///< W_i [-]
  };
  struct Constants {
    Mat3 stiffness = Mat3::Zero();  ///< K [N m/rad], symmetric
    std::array<HeldEdge, Edges> edges;
  };

  /// The section that turns with an edge, and therefore by the same rotation.
  static SectionFrame carried_by(const SectionFrame& edge, const Mat3& section) {
    Mat3 axes;
    axes << edge.first, edge.second, edge.tangent;
    const Mat3 carried = axes * section;
    return {carried.col(2), carried.col(0), carried.col(1)};
  }

  /// The rotation r that it measures [rad], and the moment K r [N m], towards the directors and
  /// about the tangent.
  struct Response {
    Vec3 rotation;
    Vec3 moment;
  };
  static Response response(const Constants& c, const Configuration& here,
                           const Eigen::Matrix<double, kDofs, 1>& x) {
    const auto measured = measure(c, here, x, std::make_index_sequence<Edges>{});
    const Vec3 rotation = weighted_rotation(c, measured);
    return {rotation, c.stiffness * rotation};
  }

  /// The moments that the spring exerts on its edges, and their sum.
  static EdgeMoments moments(const Constants& c, const Configuration& here,
                             const Eigen::Matrix<double, kDofs, 1>& x) {
    std::array<Measured, Edges> measured = measure(c, here, x, std::make_index_sequence<Edges>{});
    const Vec3 moment = c.stiffness * weighted_rotation(c, measured);
    EdgeMoments result;
    for (std::size_t i = 0; i < Edges; ++i) {
      measured[i].find_slopes(c.edges[i].weights);
      result.on_edge[i] = -(measured[i].slopes * moment);
      result.whole += result.on_edge[i];
    }
    return result;
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    std::array<Measured, Edges> measured = measure(c, here, x, std::make_index_sequence<Edges>{});
    const Vec3 rotation = weighted_rotation(c, measured);
    const Vec3 moment = c.stiffness * rotation;
    out.energy = 0.5 * moment.dot(rotation);
    if constexpr (D == Derivatives::Energy) return;

    for (std::size_t i = 0; i < Edges; ++i) {
      measured[i].find_slopes(c.edges[i].weights);
    }
    out.gradient.setZero();
    for (int i = 0; i < Edges; ++i) {
      const Measured& own = measured[std::size_t(i)];
      const Eigen::Vector4d force = own.map.transpose() * (own.slopes * moment);
      out.gradient.template segment<3>(3 * i) -= force.head<3>();
      out.gradient.template segment<3>(3 * i + 3) += force.head<3>();
      out.gradient[3 * kNodes + i] = force[3];
    }
    if constexpr (D == Derivatives::Gradient) return;

    out.hessian.setZero();
    for (int i = 0; i < Edges; ++i) {
      for (int j = 0; j <= i; ++j) {
        const Measured& row = measured[std::size_t(i)];
        const Measured& column = measured[std::size_t(j)];
        Eigen::Matrix4d block = row.map.transpose() *
                                (row.slopes * c.stiffness * column.slopes.transpose()) * column.map;
        if (i == j) block += row.curving(c.edges[std::size_t(i)].weights.transpose() * moment);
        add_block(i, j, block, out.hessian);
        if (i != j) add_block(j, i, block.transpose(), out.hessian);
      }
    }
  }

 private:
  /// The rotation of one edge with its derivatives.
  struct Measured {
    EdgeFrame edge;
    JointKinematics<AngleCurvature> kinematics;
    Eigen::Matrix<double, 3, 4> map;  // omega by the edge's vector and angle
    Mat3 slopes;                      // of the weighted strains by omega, one a column

    [[nodiscard]] Vec3 strain() const {
      const JointStrain& s = kinematics.strain();
      return {s.kappa_1, s.kappa_2, s.twist};
    }
    /// The response to `moment` [N m] on the strains, which stays as it is.
    template <bool with_stiffness>
    [[nodiscard]] JointResponse response(const Vec3& moment, const Vec3& stiffness) const {
      // A joint whose strain has the moment as its force.
      const Vec3 rest = strain() - moment.cwiseQuotient(stiffness);
      JointResponse result;
      kinematics.template respond<with_stiffness>(
          {stiffness[0], stiffness[1], stiffness[2], {rest[0], rest[1], rest[2]}}, result);
      return result;
    }
    void find_slopes(const Mat3& weights) {
      map = edge.rotation();
      Mat3 of_strains;
      for (int k = 0; k < 3; ++k) {
        of_strains.col(k) = response<false>(Vec3::Unit(k), Vec3::Ones()).moment;
      }
      slopes = of_strains * weights.transpose();
    }
    /// The second derivatives of the strains times `moment`, by the edge's vector and angle. A
    /// joint as stiff as the moment is large has them, and its slopes beside, which are taken off:
    /// any other stiffness would leave roundings of its own.
    [[nodiscard]] Eigen::Matrix4d curving(const Vec3& moment) const {
      const double stiffness = moment.lpNorm<Eigen::Infinity>();
      if (stiffness == 0.0) return Eigen::Matrix4d::Zero();
      JointResponse whole = response<true>(moment, Vec3::Constant(stiffness));
      for (int k = 0; k < 3; ++k) {
        const Vec3 slope = response<false>(Vec3::Unit(k), Vec3::Ones()).moment;
        whole.stiffness -= stiffness * slope * slope.transpose();
      }
      return map.transpose() * whole.stiffness * map + edge.geometric_stiffness(whole.moment);
    }
  };

  /// sum_i W_i kappa_i, one component for each axis.
  static Vec3 weighted_rotation(const Constants& c, const std::array<Measured, Edges>& measured) {
    Vec3 rotation = Vec3::Zero();
    for (std::size_t i = 0; i < Edges; ++i) {
      rotation += c.edges[i].weights * measured[i].strain();
    }
    return rotation;
  }

  template <std::size_t... i>
  static std::array<Measured, Edges> measure(const Constants& c, const Configuration& here,
                                             const Eigen::Matrix<double, kDofs, 1>& x,
                                             std::index_sequence<i...> /*edges*/) {
    return {{measure(c, here, x, int(i))...}};
  }
  static Measured measure(const Constants& c, const Configuration& here,
                          const Eigen::Matrix<double, kDofs, 1>& x, int i) {
    const Vector& values = here.controls;
    const HeldEdge& held = c.edges[std::size_t(i)];
    const double theta = x[3 * kNodes + i];
    const Vec3 vector = x.template segment<3>(3 * i + 3) + held.last.offset(values) -
                        x.template segment<3>(3 * i) - held.first.offset(values);
    const EdgeFrame edge(vector, theta, held.block.tangent(values), held.block.director(values));
    const SectionFrame section = carried_by(edge.frame, held.carried);
    const double near = held.reference_twist < 0 ? 0.0 : theta - values[held.reference_twist];
    const double twist = nearest_turn(twist_between(held.drawn, section), near);
    return {edge, {held.drawn, section, twist}, {}, {}};
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
