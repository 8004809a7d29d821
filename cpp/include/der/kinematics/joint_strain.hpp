#pragma once

namespace der {

/// Curvature, integrated over the joint between two edges, towards the two directors, and its twist
/// [rad].
struct JointStrain {
  double kappa_1 = 0.0;
  double kappa_2 = 0.0;
  double twist = 0.0;
};

}  // namespace der
