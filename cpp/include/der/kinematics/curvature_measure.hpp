#pragma once

#include <cmath>

namespace der {

/// Integrated curvature kappa as a function of the turning angle phi at a node, with its first two
/// derivatives.
struct CurvatureValue {
  double kappa = 0.0;
  double first = 1.0;
  double second = 0.0;
};

/// The turning angle itself. Converges with a clean second order and stays finite at a fold.
struct AngleCurvature {
  static CurvatureValue of(double phi) { return {phi, 1.0, 0.0}; }
};

/// The classic measure 2 tan(phi/2) (Bergou et al., Discrete Elastic Rods, SIGGRAPH 2008, eq. 1),
/// which goes to infinity at a fold.
struct TangentCurvature {
  static CurvatureValue of(double phi) {
    const double kappa = 2.0 * std::tan(0.5 * phi);
    const double first = 1.0 + 0.25 * kappa * kappa;
    return {kappa, first, 0.5 * kappa * first};
  }
};

}  // namespace der
