#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "der/core/types.hpp"
#include "der/energies/driven_tangents.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/curvature_measure.hpp"
#include "der/kinematics/natural_strain_offset.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {

/// Bending of a leg next to joints, in a plane. With s_i = kappa(phi_i) - rest_i of the turning
/// angles phi_i between consecutive directions
///   E = 1/2 s' K s.
/// The directions are the tangent of the joint, those of `Edges` edges that follow it, and with two
/// `Joints` the tangent of the joint behind them. K is the inverse of the compliance of a beam
/// whose moment is linear between the nodes (building/leg_elements.cpp): the moment at a joint is
/// the first or last entry of K s, and the ends of a leg are exact in the linear theory.
///
/// Coordinates: those of the nodes, from a joint on, then the rotations of the joints [rad]. Where
/// a leg arrives at its joint, the element runs against the sense of growing arc length, and all
/// angles change their sign.
template <class Curvature, int Edges, int Joints>
struct EndCell {
  static_assert(Edges == 1 || Edges == 2);
  static_assert(Joints == 1 || Joints == 2);
  static constexpr int kNodes = Edges + 1;
  static constexpr int kJoints = Joints;
  static constexpr int kAngles = Edges + Joints - 1;
  static constexpr int kDirections = Edges + Joints;
  static constexpr int kDofs = 2 * kNodes + Joints;
  static constexpr EnergyTerm kTerm = EnergyTerm::Bend;

  using Angles = Eigen::Matrix<double, kAngles, 1>;
  using Stiffness = Eigen::Matrix<double, kAngles, kAngles>;
  using Coordinates = Eigen::Matrix<double, kDofs, 1>;

  struct Constants {
    Stiffness stiffness = Stiffness::Zero();  ///< K [N m]
    Angles rest = Angles::Zero();             ///< natural kappa [-]
    /// Angle [rad] of the leg's tangent at each joint, along the element, where the joint has not
    /// turned.
    std::array<double, Joints> direction{};
    NaturalStrainOffset actuated{};  ///< of `rest`: an entry for each angle
    DrivenTangents<Joints> driven{};

    [[nodiscard]] Angles natural(const Vector& controls) const {
      if (actuated.entry < 0) return rest;
      return rest + controls.segment<kAngles>(actuated.entry);
    }
  };

  /// The moments [N m] at the joint and at the nodes behind it, along the element: the derivatives
  /// of the energy by the turning angles. `natural` [-] has the place of the natural kappa.
  static Angles moments(const Constants& c, const Angles& natural, const Coordinates& x) {
    return Response(c, natural, x).moment;
  }
  /// The derivatives of the energy by kappa [N m].
  static Angles loads(const Constants& c, const Angles& natural, const Coordinates& x) {
    return Response(c, natural, x).load;
  }
  /// The derivatives of each kappa by its turning angle.
  static Angles measure_slopes(const Constants& c, const Coordinates& x) {
    return Response(c, c.rest, x).slope;
  }
  /// The gradients of kappa, a row for each angle.
  static Eigen::Matrix<double, kAngles, kDofs> gradients(const Constants& c, const Coordinates& x) {
    const Response response(c, c.rest, x);
    return response.slope.asDiagonal() * by_angles(direction_gradients(response)).transpose();
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here, const Coordinates& x,
                       LocalTerm<kDofs>& out) {
    const Response response(c, c.natural(here.controls), c.driven.turned_by(here.controls, x));
    out.energy = response.energy;
    if constexpr (D == Derivatives::Energy) return;

    // By each direction: what turns it away from the one before turns it towards the next.
    Eigen::Matrix<double, kDirections, 1> by_direction;
    for (int i = 0; i < kDirections; ++i) {
      by_direction[i] =
          (i > 0 ? response.moment[i - 1] : 0.0) - (i < kAngles ? response.moment[i] : 0.0);
    }
    const DirectionGradients slopes = direction_gradients(response);
    out.gradient.noalias() = slopes * by_direction;
    if constexpr (D == Derivatives::Gradient) return;

    const auto turning = by_angles(slopes);
    out.hessian.noalias() = turning * response.stiffness * turning.transpose();
    for (int i = 0; i < Edges; ++i) {
      const Mat2 h = by_direction[i + 1] *
                     direction_hessian(response.vectors[std::size_t(i) + 1],
                                       Vec2(slopes.template block<2, 1>(2 * i + 2, i + 1)),
                                       response.inverse_squared(i));
      out.hessian.template block<2, 2>(2 * i, 2 * i) += h;
      out.hessian.template block<2, 2>(2 * i, 2 * i + 2) -= h;
      out.hessian.template block<2, 2>(2 * i + 2, 2 * i) -= h;
      out.hessian.template block<2, 2>(2 * i + 2, 2 * i + 2) += h;
    }
  }

 private:
  /// Energy, and its first and second derivatives by the turning angles.
  struct Response {
    std::array<Vec2, kDirections> vectors;  ///< whose directions count; unit vectors of joints
    double energy = 0.0;
    Angles slope;  ///< of kappa by the turning angle
    Angles load;   ///< by kappa
    Angles moment;
    Stiffness stiffness;

    Response(const Constants& c, const Angles& natural, const Coordinates& x) {
      const auto tangent = [&](int joint) {
        const double angle = c.direction[std::size_t(joint)] + x[2 * kNodes + joint];
        return Vec2(std::cos(angle), std::sin(angle));
      };
      vectors.front() = tangent(0);
      for (int i = 0; i < Edges; ++i) {
        vectors[std::size_t(i) + 1] =
            x.template segment<2>(2 * i + 2) - x.template segment<2>(2 * i);
      }
      if constexpr (Joints == 2) vectors.back() = tangent(1);
      Angles excess;
      Angles second;
      for (int i = 0; i < kAngles; ++i) {
        const CurvatureValue k =
            Curvature::of(angle_between(vectors[std::size_t(i)], vectors[std::size_t(i) + 1]));
        excess[i] = k.kappa - natural[i];
        slope[i] = k.first;
        second[i] = k.second;
      }
      load = c.stiffness * excess;
      energy = 0.5 * excess.dot(load);
      moment = slope.cwiseProduct(load);
      stiffness = slope.asDiagonal() * c.stiffness * slope.asDiagonal();
      stiffness.diagonal() += load.cwiseProduct(second);
    }
    /// One over the squared length of an edge [1/m^2].
    [[nodiscard]] double inverse_squared(int edge) const {
      return 1.0 / vectors[std::size_t(edge) + 1].squaredNorm();
    }
  };

  using DirectionGradients = Eigen::Matrix<double, kDofs, kDirections>;
  /// Derivatives of all directions by the coordinates, a column for each.
  static DirectionGradients direction_gradients(const Response& response) {
    DirectionGradients slopes = DirectionGradients::Zero();
    slopes(2 * kNodes, 0) = 1.0;
    if constexpr (Joints == 2) slopes(2 * kNodes + 1, kDirections - 1) = 1.0;
    for (int i = 0; i < Edges; ++i) {
      const Vec2 slope =
          direction_gradient(response.vectors[std::size_t(i) + 1], response.inverse_squared(i));
      slopes.template block<2, 1>(2 * i, i + 1) = -slope;
      slopes.template block<2, 1>(2 * i + 2, i + 1) = slope;
    }
    return slopes;
  }
  /// The same of the turning angles.
  static Eigen::Matrix<double, kDofs, kAngles> by_angles(const DirectionGradients& slopes) {
    return slopes.template rightCols<kAngles>() - slopes.template leftCols<kAngles>();
  }
};

}  // namespace der
