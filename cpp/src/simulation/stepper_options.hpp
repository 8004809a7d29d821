#pragma once

#include "der/scenario/scenario.hpp"
#include "der/steppers/stepper.hpp"

namespace der {

/// The settings of a scene for its stepper and for Newton's method.
StepperOptions stepper_options(const scenario::Scene& scene);

}  // namespace der
