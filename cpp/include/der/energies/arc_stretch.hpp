#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "der/core/types.hpp"
#include "der/energies/driven_tangents.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/natural_strain_offset.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {

/// The correction of an edge's stretching energy: the edge is not as long as the arc between
/// its nodes, in a plane. A node inside a leg lies l^2/12 of the curvature beside the curve, a
/// joint on it, so that the arc has the length |e| (1 - g) with a quadratic form g = phi' G phi of
/// the turning angles phi next to the edge:
///   E = 1/2 EA/l ((|e| (1 - g) - l - a)^2 - (|e| - l - a)^2),
/// with the rest length l and the elongation a by actuations. With it a leg is of order 4.
/// G is made of the curvatures at the edge's two nodes (building/arc_form.hpp).
///
/// The angles are those between consecutive directions: the tangent of a joint, if there is one,
/// those of `Edges` edges, and with two `Joints` the tangent of the joint behind them.
/// Coordinates: those of the nodes, from the joint on, then the rotations of the joints [rad].
/// Where a leg arrives at its joint, the element runs against the sense of growing arc length.
template <int Edges, int Joints>
struct ArcStretch {
  static constexpr int kNodes = Edges + 1;
  static constexpr int kJoints = Joints;
  static constexpr int kDirections = Edges + Joints;
  static constexpr int kAngles = kDirections - 1;
  static constexpr int kFirstEdge = Joints > 0 ? 1 : 0;  ///< its direction
  static constexpr int kDofs = 2 * kNodes + Joints;
  static constexpr EnergyTerm kTerm = EnergyTerm::Stretch;

  using Angles = Eigen::Matrix<double, kAngles, 1>;
  using Directions = Eigen::Matrix<double, kDirections, 1>;
  using Form = Eigen::Matrix<double, kAngles, kAngles>;
  using Coordinates = Eigen::Matrix<double, kDofs, 1>;

  struct Constants {
    double EA = 0.0;                       ///< [N]
    double rest_length = 0.0;              ///< [m]
    Form form = Form::Zero();              ///< G [-]
    int edge = 0;                          ///< which of the edges it is
    std::array<double, Joints> direction;  ///< as in EndCell [rad]
    NaturalStrainOffset elongation{};      ///< [m]
    DrivenTangents<Joints> driven{};
  };

  /// The derivatives of the energy by the length of the edge [N] and by the turning angles [N m].
  struct Loads {
    double tension = 0.0;
    Angles moments;
  };
  static Loads loads(const Constants& c, double elongation, const Coordinates& x) {
    const Response response(c, elongation, x);
    return {response.tension, response.moments};
  }
  /// That by the elongation [N].
  static double by_elongation(const Constants& c, double elongation, const Coordinates& x) {
    const Response response(c, elongation, x);
    return c.EA / c.rest_length * response.length * response.g;
  }

  /// The derivatives of the length of the arc by the length of the edge [-] and by the turning
  /// angles [m].
  struct ArcSlopes {
    double length = 0.0;
    Angles angles;
  };
  static ArcSlopes arc_slopes(const Constants& c, const Coordinates& x) {
    return Response(c, 0.0, x).arc_slopes();
  }
  /// The gradients of the length of the arc, and of that of the edge [-].
  static std::array<Coordinates, 2> length_gradients(const Constants& c, const Coordinates& x) {
    const Response response(c, 0.0, x);
    const ArcSlopes slopes = response.arc_slopes();
    const EdgeTurns turns(response);
    return {spread(c, response, turns, slopes.length, by_directions(slopes.angles)),
            spread(c, response, turns, 1.0, Directions::Zero())};
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here, const Coordinates& x,
                       LocalTerm<kDofs>& out) {
    const Response response(c, c.elongation.value(here.controls),
                            c.driven.turned_by(here.controls, x));
    const double per_length = c.EA / c.rest_length;
    const double arc = response.arc();
    const double extension = response.extension;
    const double length = response.length;
    out.energy = 0.5 * per_length * (arc - length) * (extension + response.plain);
    if constexpr (D == Derivatives::Energy) return;

    const Directions moments = by_directions(response.moments);
    const EdgeTurns turns(response);
    const auto& turn = turns.gradient;
    const auto& inverse = turns.inverse;
    out.gradient = spread(c, response, turns, response.tension, moments);
    if constexpr (D == Derivatives::Gradient) return;

    const Vec2 tangent = response.vector(c.edge) / length;
    const Directions slope_of_g = by_directions(response.slope_of_g);
    // By the directions, and by the length and a direction.
    Eigen::Matrix<double, kDirections, kDirections> stiffness =
        length * slope_of_g * slope_of_g.transpose();
    for (int i = 0; i < kAngles; ++i) {
      for (int j = 0; j < kAngles; ++j) {
        const double h = 2.0 * extension * c.form(i, j);
        stiffness(i, j) -= h;
        stiffness(i + 1, j + 1) -= h;
        stiffness(i + 1, j) += h;
        stiffness(i, j + 1) += h;
      }
    }
    stiffness *= per_length * length;
    const Directions mixed = -per_length * (arc + extension) * slope_of_g;
    // By the vector of edge i and a direction.
    const auto by_edge = [&](int i, int direction) -> Vec2 {
      Vec2 sum = stiffness(kFirstEdge + i, direction) * turn[std::size_t(i)];
      if (i == c.edge) sum += mixed[direction] * tangent;
      return sum;
    };
    // By the vectors of edges i and j, where edge e has the nodes e and e + 1.
    out.hessian.setZero();
    for (int i = 0; i < Edges; ++i) {
      for (int j = 0; j <= i; ++j) {
        Mat2 h = by_edge(i, kFirstEdge + j) * turn[std::size_t(j)].transpose();
        if (j == c.edge) {
          h += mixed[kFirstEdge + i] * turn[std::size_t(i)] * tangent.transpose();
        }
        if (i == j) {
          h += moments[kFirstEdge + i] *
               direction_hessian(response.vector(i), turn[std::size_t(i)], inverse[std::size_t(i)]);
          if (i == c.edge) {
            const double across = response.tension / length;
            h += (-per_length * response.g * (2.0 - response.g) - across) * tangent *
                 tangent.transpose();
            h.diagonal().array() += across;
          }
        }
        const auto add = [&](int row, int column, double sign) {
          out.hessian.template block<2, 2>(2 * row, 2 * column) += sign * h;
        };
        add(i, j, 1.0);
        add(i + 1, j + 1, 1.0);
        add(i + 1, j, -1.0);
        if (j + 1 <= i) add(i, j + 1, -1.0);
        // Between the two ends of one edge only the lower triangle counts; of two edges in a row
        // the block that lies above it belongs to the diagonal.
        if (i == j + 1) out.hessian.template block<2, 2>(2 * i, 2 * i) -= h.transpose();
      }
    }
    for (int k = 0; k < Joints; ++k) {
      const int direction = direction_of(k);
      const int row = 2 * kNodes + k;
      for (int i = 0; i < Edges; ++i) {
        const Vec2 h = by_edge(i, direction);
        out.hessian.template block<1, 2>(row, 2 * i) -= h.transpose();
        out.hessian.template block<1, 2>(row, 2 * i + 2) += h.transpose();
      }
      for (int m = 0; m <= k; ++m) {
        out.hessian(row, 2 * kNodes + m) = stiffness(direction, direction_of(m));
      }
    }
  }

 private:
  struct Response {
    std::array<Vec2, kDirections> vectors;  ///< whose directions count; unit vectors of joints
    double length = 0.0;                    ///< of the edge [m]
    double g = 0.0;
    double extension = 0.0;  ///< of the arc [m]
    double plain = 0.0;      ///< of the edge, were it as long as the arc [m]
    double tension = 0.0;
    Angles slope_of_g;
    Angles moments;

    Response(const Constants& c, double elongation, const Coordinates& x) {
      const auto tangent = [&](int joint) {
        const double angle = c.direction[std::size_t(joint)] + x[2 * kNodes + joint];
        return Vec2(std::cos(angle), std::sin(angle));
      };
      if constexpr (Joints > 0) vectors.front() = tangent(0);
      for (int i = 0; i < Edges; ++i) {
        vectors[std::size_t(kFirstEdge + i)] =
            x.template segment<2>(2 * i + 2) - x.template segment<2>(2 * i);
      }
      if constexpr (Joints == 2) vectors.back() = tangent(1);
      Angles phi;
      for (int i = 0; i < kAngles; ++i) {
        phi[i] = angle_between(vectors[std::size_t(i)], vectors[std::size_t(i) + 1]);
      }
      slope_of_g = c.form * phi;
      g = phi.dot(slope_of_g);
      slope_of_g *= 2.0;
      length = vector(c.edge).norm();
      plain = length - c.rest_length - elongation;
      extension = plain - length * g;
      const double per_length = c.EA / c.rest_length;
      tension = per_length * (extension * (1.0 - g) - plain);
      moments = -per_length * extension * length * slope_of_g;
    }
    [[nodiscard]] const Vec2& vector(int edge) const {
      return vectors[std::size_t(kFirstEdge + edge)];
    }
    [[nodiscard]] double arc() const { return length * (1.0 - g); }
    [[nodiscard]] ArcSlopes arc_slopes() const { return {1.0 - g, -length * slope_of_g}; }
  };

  /// How the vector of each edge turns its direction.
  struct EdgeTurns {
    std::array<Vec2, Edges> gradient;     ///< [1/m]
    std::array<double, Edges> inverse{};  ///< of its squared length [1/m^2]
    explicit EdgeTurns(const Response& response) {
      for (int i = 0; i < Edges; ++i) {
        inverse[std::size_t(i)] = 1.0 / response.vector(i).squaredNorm();
        gradient[std::size_t(i)] = direction_gradient(response.vector(i), inverse[std::size_t(i)]);
      }
    }
  };
  static constexpr int direction_of(int joint) { return joint == 0 ? 0 : kDirections - 1; }
  /// By the directions: what turns one away from that before turns it towards the next.
  static Directions by_directions(const Angles& by_angles) {
    Directions sum = Directions::Zero();
    sum.template tail<kAngles>() = by_angles;
    sum.template head<kAngles>() -= by_angles;
    return sum;
  }
  /// The derivatives by the coordinates of what has these by the length of the edge and by the
  /// directions.
  static Coordinates spread(const Constants& c, const Response& response, const EdgeTurns& turns,
                            double by_length, const Directions& turning) {
    Coordinates result = Coordinates::Zero();
    for (int i = 0; i < Edges; ++i) {
      Vec2 pull = turning[kFirstEdge + i] * turns.gradient[std::size_t(i)];
      if (i == c.edge) pull += by_length / response.length * response.vector(i);
      result.template segment<2>(2 * i) -= pull;
      result.template segment<2>(2 * i + 2) += pull;
    }
    for (int j = 0; j < Joints; ++j) result[2 * kNodes + j] = turning[direction_of(j)];
    return result;
  }
};

template <class Kernel>
struct IsArcStretch : std::false_type {};
template <int Edges, int Joints>
struct IsArcStretch<ArcStretch<Edges, Joints>> : std::true_type {};

}  // namespace der
