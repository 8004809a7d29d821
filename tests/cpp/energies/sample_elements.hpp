#pragma once

#include <cmath>
#include <random>

#include "der/energies/registry.hpp"

/// Random constants and configurations for every kind of element, for the checks that loop over the
/// registry. A new kind needs an overload of `sample_constants` here, or the tests do not compile.
namespace der::test {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// All that elements read of a configuration besides their own coordinates: the controls that the
/// sampled constants refer to, a moment, a rotation, and a turn so far.
inline Configuration sample_configuration(Random& random) {
  Configuration here;
  here.controls.resize(3);
  here.controls << uniform(random, -2.0, 2.0), uniform(random, -1.0, 1.0),
      uniform(random, -1.0, 1.0);
  return here;
}

inline Stretch<2>::Constants sample_constants(const Stretch<2>&, Random& random) {
  return {uniform(random, 1.0, 100.0), uniform(random, 0.5, 2.0)};
}

template <class Curvature>
typename PlanarBend<Curvature>::Constants sample_constants(const PlanarBend<Curvature>&,
                                                           Random& random) {
  return {uniform(random, 0.5, 5.0), uniform(random, -1.0, 1.0)};
}

template <class Curvature>
typename PlanarClamp<Curvature>::Constants sample_constants(const PlanarClamp<Curvature>&,
                                                            Random& random) {
  return {uniform(random, 0.5, 5.0), uniform(random, -1.0, 1.0), uniform(random, -0.5, 0.5),
          uniform(random, 0.0, 1.0) < 0.5 ? -1.0 : 1.0, 1};
}

inline PlanarMoment::Constants sample_constants(const PlanarMoment&, Random& random) {
  return {uniform(random, 0.1, 1.0), 0};
}

inline Foundation::Constants sample_constants(const Foundation&, Random& random) {
  Foundation::Constants c;
  c.stiffness << uniform(random, 0.5, 5.0), uniform(random, 0.0, 5.0);
  for (double& coordinate : c.drawn) coordinate = uniform(random, -1.0, 1.0);
  const double shared = uniform(random, 0.0, 0.2);
  c.lengths << uniform(random, 0.2, 0.5), shared, shared, uniform(random, 0.2, 0.5);
  return c;
}

template <int Nodes>
typename PointSpring<Nodes>::Constants sample_constants(const PointSpring<Nodes>&, Random& random) {
  typename PointSpring<Nodes>::Constants c;
  c.stiffness << uniform(random, 0.5, 5.0), uniform(random, 0.0, 5.0);
  c.anchor << uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0);
  for (int i = 0; i < Nodes; ++i) c.weights[i] = uniform(random, -0.1, 1.0);
  return c;
}

template <int Edges>
typename RotationalSpring<Edges>::Constants sample_constants(const RotationalSpring<Edges>&,
                                                             Random& random) {
  typename RotationalSpring<Edges>::Constants c;
  c.stiffness = uniform(random, 0.5, 5.0);
  c.direction = uniform(random, -0.5, 0.5);
  c.rest = uniform(random, -1.0, 1.0);
  c.turn = 2;
  c.weights.back() = Edges == 1 ? 1.0 : uniform(random, -0.1, 1.1);
  c.weights.front() = Edges == 1 ? 1.0 : 1.0 - c.weights.back();
  return c;
}

template <class Kernel>
typename FromPivot<Kernel>::Constants sample_constants(const FromPivot<Kernel>&, Random& random) {
  const auto pivot = [&] {
    // Short enough for edges that are nearly folded to stay so.
    return Pivot{uniform(random, -0.01, 0.01), uniform(random, -0.5, 0.5), 1};
  };
  return {sample_constants(Kernel{}, random), pivot(), pivot()};
}

enum class Shape { Arbitrary, NearStraight, NearFolded, Stretched };
constexpr Shape kShapes[] = {Shape::Arbitrary, Shape::NearStraight, Shape::NearFolded,
                             Shape::Stretched};

/// Nodes of a planar stencil with N coordinates: edges laid one after the other, each turned from
/// the one before by an angle that the shape decides. The first edge stays within 1.5 rad of the x
/// axis, the clamped direction within 0.5 + 1 rad of it: no angle crosses its cut at pi.
template <int N>
Eigen::Matrix<double, N, 1> sample_positions(Shape shape, Random& random) {
  Eigen::Matrix<double, N, 1> x;
  x.template head<2>() << uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0);
  double direction = uniform(random, -1.5, 1.5);
  for (int node = 1; node < N / 2; ++node) {
    double length = uniform(random, 0.7, 1.4);
    if (shape == Shape::Stretched) length *= std::exp(uniform(random, -1.5, 1.5));
    x.template segment<2>(2 * node) = x.template segment<2>(2 * node - 2) +
                                      length * Vec2{std::cos(direction), std::sin(direction)};
    const double sign = uniform(random, -1.0, 1.0) < 0.0 ? -1.0 : 1.0;
    switch (shape) {
      case Shape::NearStraight:
        direction += sign * std::pow(10.0, uniform(random, -9.0, -3.0));
        break;
      case Shape::NearFolded:
        direction += sign * (3.14159265358979 - uniform(random, 0.05, 0.2));
        break;
      default:
        direction += uniform(random, -2.5, 2.5);
    }
  }
  return x;
}

}  // namespace der::test
