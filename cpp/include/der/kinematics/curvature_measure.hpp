#pragma once

#include <cmath>

#include "der/core/lanes.hpp"

namespace der {

/// Integrated curvature kappa as a function of the turning angle phi at a node, with its first two
/// derivatives.
template <class T>
struct CurvatureValueOf {
  T kappa = 0.0;
  T first = 1.0;
  T second = 0.0;
};
using CurvatureValue = CurvatureValueOf<double>;

/// The turning angle itself. Converges with a clean second order and stays finite at a fold.
struct AngleCurvature {
  template <class T>
  static CurvatureValueOf<T> of(const T& phi) {
    return {phi, 1.0, 0.0};
  }
};

/// The classic measure 2 tan(phi/2) (Bergou et al., Discrete Elastic Rods, SIGGRAPH 2008, eq. 1),
/// which goes to infinity at a fold.
struct TangentCurvature {
  template <class T>
  static CurvatureValueOf<T> of(const T& phi) {
    const T kappa =
        2.0 * in_lanes<T>([&](int lane) { return std::tan(0.5 * LaneTraits<T>::lane(phi, lane)); });
    const T first = 1.0 + 0.25 * kappa * kappa;
    return {kappa, first, 0.5 * kappa * first};
  }
};

}  // namespace der
