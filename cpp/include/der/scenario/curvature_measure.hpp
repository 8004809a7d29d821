#pragma once

namespace der::scenario {

/// How the turning angle at a node measures bending (kinematics/curvature_measure.hpp).
enum class CurvatureMeasure { Angle, Tangent };

}  // namespace der::scenario
