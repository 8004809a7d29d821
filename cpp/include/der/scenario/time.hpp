#pragma once

#include <string>

namespace der::scenario {

/// How long the time steps are.
enum class Stepping {
  Fixed,      ///< `step: 0.01`
  Automatic,  ///< `step: auto`: what an explicit integrator can take
  Adaptive,   ///< `tolerance: 1e-3`: by error control
};

/// More steps than anyone can wait for.
constexpr double kMostSteps = 1e12;

struct Time {
  double duration = 0.0;  ///< [s]
  Stepping stepping = Stepping::Fixed;
  double step = 0.0;       ///< [s] of Stepping::Fixed
  double tolerance = 0.0;  ///< of Stepping::Adaptive: error of positions over the structure's size
  std::string integrator = "tr_bdf2";
  /// Whether an explicit step above the stable one may run, and a motion in which the integrator
  /// creates energy.
  bool allow_unstable = false;
  double minimum_step = 0.0;  ///< [s] floor for retries after a failed step; 0: not given
  /// For generalized_alpha: spectral radius at infinite frequency (0: full damping, 1: none).
  double spectral_radius = 0.9;
};

}  // namespace der::scenario
