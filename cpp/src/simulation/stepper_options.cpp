#include "simulation/stepper_options.hpp"

#include <algorithm>

namespace der {
namespace {

/// Newton's error must not show in the estimated error of a step, which is a small part of the
/// tolerance.
constexpr double kNewtonShare = 1e-5;

}  // namespace

StepperOptions stepper_options(const scenario::Scene& scene) {
  StepperOptions options;
  options.newton = {scene.solver.residual_tolerance, scene.solver.step_tolerance,
                    scene.solver.max_iterations};
  if (scene.time.stepping == scenario::Stepping::Adaptive) {
    options.newton.step_tolerance =
        std::min(options.newton.step_tolerance, kNewtonShare * scene.time.tolerance);
  }
  options.spectral_radius = scene.time.spectral_radius;
  return options;
}

}  // namespace der
