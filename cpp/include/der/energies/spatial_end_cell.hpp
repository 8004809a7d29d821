#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <utility>

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/vertex_response.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/kinematics/joint_turn.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// Bending and twist of a leg in space next to joints: EndCell with three strains in each cell.
/// Each bending couples with its own in the other cells,
///   E = 1/2 sum_k EI_k s_k' C^-1 s_k + 1/2 sum_i GJ/l_i t_i^2,
/// s_k the curvatures towards director k less the natural ones, C the compliance of a beam whose
/// moment is linear along the leg (model/leg.hpp), t_i the twists and l_i the lengths over which
/// they are.
///
/// Coordinates: those of the nodes, in the sense of growing arc length, then the angles of the
/// edges, then three for each joint (JointTurn).
template <class Curvature, int Edges, int Joints>
struct SpatialEndCell {
  static_assert(Edges == 1 || Edges == 2);
  static_assert(Joints == 1 || Joints == 2);
  static constexpr int kNodes = Edges + 1;
  static constexpr int kJoints = 3 * Joints;  ///< coordinates of joints
  static constexpr int kCells = Edges + Joints - 1;
  static constexpr int kFrames = Edges + Joints;
  static constexpr int kDofs = 3 * kNodes + Edges + kJoints;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;

  using Coordinates = Eigen::Matrix<double, kDofs, 1>;
  /// A row for each cell: towards the two directors, and twist.
  using Strains = Eigen::Matrix<double, kCells, 3>;
  using Coupling = Eigen::Matrix<double, kCells, kCells>;

  struct Constants {
    Coupling per_compliance = Coupling::Zero();  ///< C^-1 [1/m]
    double EI_1 = 0.0;                           ///< [N m^2]
    double EI_2 = 0.0;                           ///< [N m^2]
    /// GJ over the length of each cell's twist [N m].
    Eigen::Matrix<double, kCells, 1> twist = Eigen::Matrix<double, kCells, 1>::Zero();
    Strains rest = Strains::Zero();  ///< natural strains [-]
    std::array<FrameBlock, Edges> edges{};
    std::array<JointSection, Joints> joints{};
    bool leaves = true;  ///< whether the leg begins at the first joint; else it ends there

    /// Place of an edge among the frames, which follow one another along the leg.
    [[nodiscard]] int frame_of_edge(int i) const { return leaves ? i + 1 : i; }
    [[nodiscard]] int frame_of_joint(int i) const { return i == 0 && leaves ? 0 : kFrames - 1; }
    /// Whether a frame is that of a joint; and number of the edge or joint whose frame it is.
    [[nodiscard]] bool is_joint(int frame) const {
      return frame == (leaves ? 0 : kFrames - 1) || (Joints == 2 && frame == kFrames - 1);
    }
    [[nodiscard]] int number_of(int frame) const {
      if (is_joint(frame)) return Joints == 2 && frame > 0 ? 1 : 0;
      return leaves ? frame - 1 : frame;
    }
    /// Entry of the controls with the reference twist of a cell [rad].
    [[nodiscard]] Index reference_twist(int cell) const {
      if (!is_joint(cell + 1)) {
        return edges[std::size_t(number_of(cell + 1))].twist_at_start();
      }
      return edges[std::size_t(number_of(cell))].twist_at_end();
    }
  };

  /// The strains, and their loads, the derivatives of the energy by them [N m].
  struct Response {
    std::array<EdgeFrame, Edges> edges;
    std::array<JointTurn, Joints> joints;
    std::array<SectionFrame, kFrames> frames;
    std::array<VertexKinematics<Curvature>, kCells> cells;
    Strains strains;
    Strains loads;
    double energy = 0.0;

    Response(const Constants& c, const Vector& controls, const Coordinates& x)
        : edges(edges_of(c, controls, x, std::make_index_sequence<Edges>())),
          joints(joints_of(c, controls, x, std::make_index_sequence<Joints>())),
          frames(frames_of(c)),
          cells(cells_of(c, controls, x, std::make_index_sequence<kCells>())) {
      for (int i = 0; i < kCells; ++i) {
        const MaterialCurvature& strain = cells[std::size_t(i)].strain();
        strains.row(i) << strain.kappa_1, strain.kappa_2, strain.twist;
      }
      const Strains excess = strains - c.rest;
      loads.col(0) = c.EI_1 * c.per_compliance * excess.col(0);
      loads.col(1) = c.EI_2 * c.per_compliance * excess.col(1);
      loads.col(2) = c.twist.cwiseProduct(excess.col(2));
      energy = 0.5 * excess.cwiseProduct(loads).sum();
    }
    /// The moment [N m] that a cell exerts on the frame before it.
    [[nodiscard]] Vec3 moment(int cell) const {
      const auto gradients = cells[std::size_t(cell)].gradients();
      return loads(cell, 0) * gradients.kappa_1 + loads(cell, 1) * gradients.kappa_2 +
             loads(cell, 2) * gradients.twist;
    }

   private:
    template <std::size_t... I>
    static std::array<EdgeFrame, Edges> edges_of(const Constants& c, const Vector& controls,
                                                 const Coordinates& x,
                                                 std::index_sequence<I...> /*each*/) {
      return {EdgeFrame(x.template segment<3>(3 * I + 3) - x.template segment<3>(3 * I),
                        x[3 * kNodes + I], c.edges[I].tangent(controls),
                        c.edges[I].director(controls))...};
    }
    template <std::size_t... I>
    static std::array<JointTurn, Joints> joints_of(const Constants& c, const Vector& controls,
                                                   const Coordinates& x,
                                                   std::index_sequence<I...> /*each*/) {
      return {JointTurn(c.joints[I].joint, controls,
                        x.template segment<3>(kDofs - kJoints + 3 * int(I)))...};
    }
    [[nodiscard]] std::array<SectionFrame, kFrames> frames_of(const Constants& c) const {
      std::array<SectionFrame, kFrames> all;
      for (int i = 0; i < Edges; ++i) {
        all[std::size_t(c.frame_of_edge(i))] = edges[std::size_t(i)].frame;
      }
      for (int i = 0; i < Joints; ++i) {
        all[std::size_t(c.frame_of_joint(i))] =
            joints[std::size_t(i)].section(c.joints[std::size_t(i)].drawn);
      }
      return all;
    }
    /// The angle, nearly, by which the section of a frame has turned about its tangent since the
    /// reference twists were taken [rad].
    [[nodiscard]] double turned(const Constants& c, const Coordinates& x, int frame) const {
      const int number = c.number_of(frame);
      if (!c.is_joint(frame)) return x[3 * kNodes + number];
      return joints[std::size_t(number)].delta().dot(frames[std::size_t(frame)].tangent);
    }
    template <std::size_t... I>
    [[nodiscard]] std::array<VertexKinematics<Curvature>, kCells> cells_of(
        const Constants& c, const Vector& controls, const Coordinates& x,
        std::index_sequence<I...> /*each*/) const {
      return {VertexKinematics<Curvature>(
          frames[I], frames[I + 1],
          whole_twist<double>(frames[I], frames[I + 1], turned(c, x, int(I)),
                              turned(c, x, int(I) + 1), controls[c.reference_twist(int(I))]))...};
    }
  };

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here, const Coordinates& x,
                       LocalTerm<kDofs>& out) {
    const Response response(c, here.controls, x);
    out.energy = response.energy;
    if constexpr (D == Derivatives::Energy) return;

    // How the coordinates turn each frame, and the moment on it.
    using Turning = Eigen::Matrix<double, 3, kDofs>;
    std::array<Turning, kFrames> turning;
    std::array<Vec3, kFrames> on_frame;
    for (int frame = 0; frame < kFrames; ++frame) {
      Turning& turn = turning[std::size_t(frame)];
      turn.setZero();
      const int number = c.number_of(frame);
      if (c.is_joint(frame)) {
        turn.template middleCols<3>(kDofs - kJoints + 3 * number) =
            response.joints[std::size_t(number)].spin();
      } else {
        const EdgeFrame::Rotation rotation = response.edges[std::size_t(number)].rotation();
        turn.template middleCols<3>(3 * number) = -rotation.leftCols<3>();
        turn.template middleCols<3>(3 * number + 3) = rotation.leftCols<3>();
        turn.col(3 * kNodes + number) = rotation.col(3);
      }
      on_frame[std::size_t(frame)].setZero();
    }
    std::array<VertexResponse, kCells> bent;
    for (int i = 0; i < kCells; ++i) {
      const LoadedVertex load{{},
                              {response.loads(i, 0), response.loads(i, 1), response.loads(i, 2)}};
      response.cells[std::size_t(i)].template respond<D == Derivatives::Hessian>(
          load, bent[std::size_t(i)]);
      on_frame[std::size_t(i)] -= bent[std::size_t(i)].moment;
      on_frame[std::size_t(i) + 1] += bent[std::size_t(i)].moment;
    }
    out.gradient.setZero();
    for (int frame = 0; frame < kFrames; ++frame) {
      out.gradient.noalias() +=
          turning[std::size_t(frame)].transpose() * on_frame[std::size_t(frame)];
    }
    if constexpr (D == Derivatives::Gradient) return;

    out.hessian.setZero();
    std::array<Turning, kCells> strains;  // by the coordinates
    for (int i = 0; i < kCells; ++i) {
      const Turning& before = turning[std::size_t(i)];
      const Turning& after = turning[std::size_t(i) + 1];
      const Turning bends = after - before;
      const VertexResponse& cell = bent[std::size_t(i)];
      out.hessian.noalias() += bends.transpose() * cell.stiffness * bends;
      const Mat3 half = 0.5 * cross_matrix<double>(cell.moment);
      const Eigen::Matrix<double, kDofs, kDofs> coupled = after.transpose() * half * before;
      out.hessian -= coupled + coupled.transpose();
      const auto gradients = response.cells[std::size_t(i)].gradients();
      strains[std::size_t(i)].row(0) = gradients.kappa_1.transpose() * bends;
      strains[std::size_t(i)].row(1) = gradients.kappa_2.transpose() * bends;
      strains[std::size_t(i)].row(2) = gradients.twist.transpose() * bends;
    }
    for (int i = 0; i < kCells; ++i) {
      for (int j = 0; j < kCells; ++j) {
        const double share = c.per_compliance(i, j);
        const Vec3 stiffness(c.EI_1 * share, c.EI_2 * share, i == j ? c.twist[i] : 0.0);
        out.hessian.noalias() +=
            strains[std::size_t(i)].transpose() * stiffness.asDiagonal() * strains[std::size_t(j)];
      }
    }
    for (int frame = 0; frame < kFrames; ++frame) {
      add_geometric(c, response, frame, on_frame[std::size_t(frame)], out);
    }
  }

 private:
  /// Adds what the moment on a frame contributes by the second derivative of its rotation.
  static void add_geometric(const Constants& c, const Response& response, int frame,
                            const Vec3& moment, LocalTerm<kDofs>& out) {
    const int number = c.number_of(frame);
    if (c.is_joint(frame)) {
      const int at = kDofs - kJoints + 3 * number;
      out.hessian.template block<3, 3>(at, at) +=
          response.joints[std::size_t(number)].geometric_stiffness(moment);
      return;
    }
    const EdgeFrame::Block block = response.edges[std::size_t(number)].geometric_stiffness(moment);
    const std::array<int, 2> nodes{3 * number, 3 * number + 3};
    const int theta = 3 * kNodes + number;
    for (int a = 0; a < 2; ++a) {
      const double sign = a == 0 ? -1.0 : 1.0;
      for (int b = 0; b < 2; ++b) {
        out.hessian.template block<3, 3>(nodes[std::size_t(a)], nodes[std::size_t(b)]) +=
            (a == b ? 1.0 : -1.0) * block.topLeftCorner<3, 3>();
      }
      out.hessian.template block<1, 3>(theta, nodes[std::size_t(a)]) +=
          sign * block.bottomLeftCorner<1, 3>();
      out.hessian.template block<3, 1>(nodes[std::size_t(a)], theta) +=
          sign * block.topRightCorner<3, 1>();
    }
    out.hessian(theta, theta) += block(3, 3);
  }
};

}  // namespace der
