#pragma once

#include <cmath>

#include "der/core/constants.hpp"
#include "der/core/types.hpp"
#include "der/energies/arc_stretch.hpp"
#include "der/energies/axial_spring.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/local_term.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/planar_clamp.hpp"
#include "der/energies/planar_moment.hpp"
#include "der/energies/rotational_spring.hpp"
#include "der/energies/stretch.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {

// Discrete gradients of the element energies: a vector D(x0, x1) with
//   D . (x1 - x0) = E(x1) - E(x0),   D(x0, x1) = grad E((x0 + x1)/2) + O(|x1 - x0|^2),
// symmetric in x0 and x1, so that forces -D over a step keep the energy and are of order 2
// (Gonzalez, J. Nonlinear Sci. 6, 1996). Each is the midpoint's gradient of the element's quadratic
// invariants times a difference quotient of the energy in them, so that the forces of a free
// element add up to nothing and turn nothing, and the momenta are kept too (Simo and Tarnow, ZAMP
// 43, 1992). The quotients are worked out without cancellation.
//
// `discrete_gradient` sets `gradient` [N] to D of one element at given values of the tables. A
// kernel whose energy is quadratic in the positions needs no overload; every other kernel of
// registry.hpp has one. tests/cpp/energies/discrete_gradient_test.cpp fails for a kernel that lacks
// it.

template <class Kernel>
struct KernelTag {};

template <int N>
using Local = Eigen::Matrix<double, N, 1>;

/// The gradient at the middle: a discrete gradient of every quadratic energy.
template <class Kernel>
void discrete_gradient(KernelTag<Kernel> /*kernel*/, const typename Kernel::Constants& c,
                       const Configuration& here, const Local<Kernel::kDofs>& start,
                       const Local<Kernel::kDofs>& end, Local<Kernel::kDofs>& gradient) {
  LocalTerm<Kernel::kDofs> middle;
  evaluate_element<Kernel, Derivatives::Gradient>(c, here, 0.5 * (start + end), middle);
  gradient = middle.gradient;
}

/// How a planar vector turns from one value to another.
struct Turn {
  double angle = 0.0;     ///< the signed angle between the two, in (-pi, pi] [rad]
  double per_area = 0.0;  ///< the angle over the cross product of the two

  Turn(const Vec2& before, const Vec2& after) {
    const double area = cross(before, after);
    angle = angle_between(before, after);
    per_area = area == 0.0 ? 1.0 / before.dot(after) : angle / area;
  }
};

/// Discrete gradient [1/m] of the direction angle of an edge vector: the cross product of the mean
/// vector and the change is that of the two values, so that this times the change is the angle.
inline Vec2 discrete_direction_gradient(const Turn& turn, const Vec2& before, const Vec2& after) {
  return turn.per_area * perpendicular(0.5 * (before + after));
}

/// The dot and the cross product of two edge vectors, which a rigid motion leaves alone and whose
/// direction is the turning angle between the edges.
inline Vec2 relative_direction(const Vec2& a, const Vec2& b) { return {a.dot(b), cross(a, b)}; }

/// Discrete gradients [1/m] of the turning angle from edge `a` to edge `b`, by the two.
struct TurningAngleGradient {
  double change = 0.0;  ///< of the turning angle [rad]
  Vec2 by_a;
  Vec2 by_b;

  TurningAngleGradient(const Vec2& a0, const Vec2& b0, const Vec2& a1, const Vec2& b1) {
    const Vec2 before = relative_direction(a0, b0);
    const Vec2 after = relative_direction(a1, b1);
    const Turn turn(before, after);
    change = turn.angle;
    // Both products are bilinear: their gradients at the middle give their changes exactly.
    const Vec2 by_products = discrete_direction_gradient(turn, before, after);
    const Vec2 a = 0.5 * (a0 + a1);
    const Vec2 b = 0.5 * (b0 + b1);
    by_a = by_products.x() * b - by_products.y() * perpendicular(b);
    by_b = by_products.x() * a + by_products.y() * perpendicular(a);
  }
};

/// (kappa(after) - kappa(before)) / (after - before).
inline double curvature_quotient(AngleCurvature /*measure*/, double /*before*/, double /*after*/) {
  return 1.0;
}
inline double curvature_quotient(TangentCurvature /*measure*/, double before, double after) {
  const double half = 0.5 * (after - before);
  // The sine's series is exact to rounding below this.
  const double sinc = std::abs(half) < 1e-4 ? 1.0 - half * half / 6.0 : std::sin(half) / half;
  return sinc / (std::cos(0.5 * before) * std::cos(0.5 * after));
}

/// Change of the bending energy over the angle `change` by which the edges have turned against each
/// other [N m]. Kernels know a turning angle to half a turn: `after` is `before + change` but for a
/// turn that is lost beyond.
template <class Curvature>
double secant_moment(double stiffness_per_length, double rest_kappa, double before, double after,
                     double change) {
  const double mean = 0.5 * (Curvature::of(before).kappa + Curvature::of(after).kappa);
  const double moment =
      stiffness_per_length * (mean - rest_kappa) * curvature_quotient(Curvature{}, before, after);
  const double known = after - before;
  return std::abs(known - change) < kPi ? moment : moment * (known / change);
}

template <int Dim>
void discrete_gradient(KernelTag<Stretch<Dim>> /*kernel*/,
                       const typename Stretch<Dim>::Constants& c, const Configuration& here,
                       const Local<2 * Dim>& start, const Local<2 * Dim>& end,
                       Local<2 * Dim>& gradient) {
  using Vec = Eigen::Matrix<double, Dim, 1>;
  const Vec before = Stretch<Dim>::edge(start);
  const Vec after = Stretch<Dim>::edge(end);
  const double lengths = before.norm() + after.norm();
  const double natural = c.rest_length + c.elongation.value(here.controls);
  const Vec force =
      c.EA / c.rest_length * (lengths - 2.0 * natural) / lengths * 0.5 * (before + after);
  gradient.template head<Dim>() = -force;
  gradient.template tail<Dim>() = force;
}

template <int Dim>
void discrete_gradient(KernelTag<AxialSpring<Dim>> /*kernel*/,
                       const typename AxialSpring<Dim>::Constants& c, const Configuration& here,
                       const Local<2 * Dim>& start, const Local<2 * Dim>& end,
                       Local<2 * Dim>& gradient) {
  const auto before = AxialSpring<Dim>::vector(start);
  const auto after = AxialSpring<Dim>::vector(end);
  const double mean_length = 0.5 * (before.norm() + after.norm());
  const auto force = (c.across(here.controls, mean_length) * 0.5 * (before + after)).eval();
  gradient << -force, force;
}

/// By the length of the edge and the turning angles, of which the energy is a polynomial: the mean
/// of each factor times the change of the others is the change of the product.
template <int Edges>
void discrete_gradient(KernelTag<ArcStretch<Edges, 0>> /*kernel*/,
                       const typename ArcStretch<Edges, 0>::Constants& c, const Configuration& here,
                       const Local<2 * Edges + 2>& start, const Local<2 * Edges + 2>& end,
                       Local<2 * Edges + 2>& gradient) {
  using Angles = typename ArcStretch<Edges, 0>::Angles;
  const auto edge = [](const Local<2 * Edges + 2>& x, int i) -> Vec2 {
    return x.template segment<2>(2 * i + 2) - x.template segment<2>(2 * i);
  };
  Angles before;
  Angles after;
  for (int i = 0; i < Edges - 1; ++i) {
    before[i] = angle_between(edge(start, i), edge(start, i + 1));
    after[i] = angle_between(edge(end, i), edge(end, i + 1));
  }
  const Angles slope_of_g = c.form * (before + after);
  const double g0 = before.dot(c.form * before);
  const double g1 = after.dot(c.form * after);
  const double s0 = edge(start, c.edge).norm();
  const double s1 = edge(end, c.edge).norm();
  const double per_length = c.EA / c.rest_length;
  const double natural = c.rest_length + c.elongation.value(here.controls);
  const double length = 0.5 * (s0 + s1);
  const double extension = 0.5 * (s0 * (1.0 - g0) + s1 * (1.0 - g1)) - natural;
  const double tension = per_length * (extension * (1.0 - 0.5 * (g0 + g1)) - (length - natural));
  gradient.setZero();
  const auto pull = [&](int i, const Vec2& force) {
    gradient.template segment<2>(2 * i) -= force;
    gradient.template segment<2>(2 * i + 2) += force;
  };
  pull(c.edge, tension / (s0 + s1) * (edge(start, c.edge) + edge(end, c.edge)));
  for (int i = 0; i < Edges - 1; ++i) {
    const TurningAngleGradient angle(edge(start, i), edge(start, i + 1), edge(end, i),
                                     edge(end, i + 1));
    const double known = after[i] - before[i];
    double moment = -per_length * extension * length * slope_of_g[i];
    if (std::abs(known - angle.change) >= kPi) moment *= known / angle.change;
    pull(i, moment * angle.by_a);
    pull(i + 1, moment * angle.by_b);
  }
}

template <class Curvature>
void discrete_gradient(KernelTag<PlanarBend<Curvature>> /*kernel*/,
                       const typename PlanarBend<Curvature>::Constants& c,
                       const Configuration& here, const Local<6>& start, const Local<6>& end,
                       Local<6>& gradient) {
  const auto [a0, b0] = PlanarBend<Curvature>::edges(start);
  const auto [a1, b1] = PlanarBend<Curvature>::edges(end);
  const TurningAngleGradient angle(a0, b0, a1, b1);
  const double moment =
      secant_moment<Curvature>(c.stiffness_per_length, c.natural(here.controls),
                               angle_between(a0, b0), angle_between(a1, b1), angle.change);
  gradient.segment<2>(0) = -moment * angle.by_a;
  gradient.segment<2>(2) = moment * (angle.by_a - angle.by_b);
  gradient.segment<2>(4) = moment * angle.by_b;
}

template <class Curvature>
void discrete_gradient(KernelTag<PlanarClamp<Curvature>> /*kernel*/,
                       const typename PlanarClamp<Curvature>::Constants& c,
                       const Configuration& here, const Local<4>& start, const Local<4>& end,
                       Local<4>& gradient) {
  const double direction = c.direction + (c.rotation >= 0 ? here.controls[c.rotation] : 0.0);
  const Vec2 tangent{std::cos(direction), std::sin(direction)};
  const Vec2 before = start.tail<2>() - start.head<2>();
  const Vec2 after = end.tail<2>() - end.head<2>();
  const Turn turn(before, after);
  const double moment = secant_moment<Curvature>(
      c.stiffness_per_length, c.natural(here.controls), c.side * angle_between(tangent, before),
      c.side * angle_between(tangent, after), c.side * turn.angle);
  const Vec2 force = c.side * moment * discrete_direction_gradient(turn, before, after);
  gradient.head<2>() = -force;
  gradient.tail<2>() = force;
}

template <class Kernel>
void discrete_gradient(KernelTag<FromPivot<Kernel>> /*kernel*/,
                       const typename FromPivot<Kernel>::Constants& c, const Configuration& here,
                       Local<Kernel::kDofs> start, Local<Kernel::kDofs> end,
                       Local<Kernel::kDofs>& gradient) {
  const Vec2 first = c.first.offset(here.controls);
  const Vec2 last = c.last.offset(here.controls);
  for (auto* ends : {&start, &end}) {
    ends->template head<2>() += first;
    ends->template tail<2>() += last;
  }
  discrete_gradient(KernelTag<Kernel>{}, c.element, here, start, end, gradient);
}

/// It is that of the potential followed through whole turns, not of the kernel's energy, known up
/// to its period.
inline void discrete_gradient(KernelTag<PlanarMoment> /*kernel*/, const PlanarMoment::Constants& c,
                              const Configuration& here, const Local<4>& start, const Local<4>& end,
                              Local<4>& gradient) {
  const Vec2 before = start.tail<2>() - start.head<2>();
  const Vec2 after = end.tail<2>() - end.head<2>();
  const Vec2 force = c.share * here.controls[c.moment] *
                     discrete_direction_gradient(Turn(before, after), before, after);
  gradient.head<2>() = force;
  gradient.tail<2>() = -force;
}

template <int Edges>
void discrete_gradient(KernelTag<RotationalSpring<Edges>> /*kernel*/,
                       const typename RotationalSpring<Edges>::Constants& c,
                       const Configuration& here, const Local<2 * (Edges + 1)>& start,
                       const Local<2 * (Edges + 1)>& end, Local<2 * (Edges + 1)>& gradient) {
  const auto edge = [](const Local<2 * (Edges + 1)>& x, int i) -> Vec2 {
    return x.template segment<2>(2 * i + 2) - x.template segment<2>(2 * i);
  };
  const Vec2 a0 = edge(start, 0);
  const Vec2 a1 = edge(end, 0);
  const Turn first(a0, a1);
  double change = c.total * first.angle;
  double known = change;
  gradient.setZero();
  const auto act = [&gradient](int i, const Vec2& slope) {
    gradient.template segment<2>(2 * i) -= slope;
    gradient.template segment<2>(2 * i + 2) += slope;
  };
  act(0, c.total * discrete_direction_gradient(first, a0, a1));
  if constexpr (Edges == 2) {
    const Vec2 b0 = edge(start, 1);
    const Vec2 b1 = edge(end, 1);
    const TurningAngleGradient second(a0, b0, a1, b1);
    change += c.weights[1] * second.change;
    known += c.weights[1] * (angle_between(a1, b1) - angle_between(a0, b0));
    act(0, c.weights[1] * second.by_a);
    act(1, c.weights[1] * second.by_b);
  }
  const double before =
      RotationalSpring<Edges>::turn(c, here.controls[c.turn], start) + c.turned_by(here.controls);
  double moment = c.stiffness * (before + 0.5 * known);
  // As for bends, but what is lost of one of two angles is a share of a turn.
  constexpr double kLostTurn = 1e-6;
  if (std::abs(known - change) > kLostTurn) moment *= known / change;
  gradient *= moment;
}

}  // namespace der
