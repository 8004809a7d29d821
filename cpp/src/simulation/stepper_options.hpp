#pragma once

#include "der/scenario/scenario.hpp"
#include "der/steppers/stepper.hpp"

namespace der {

/// What a scene asks of its stepper, and of Newton's method.
StepperOptions stepper_options(const scenario::Scene& scene);

}  // namespace der
