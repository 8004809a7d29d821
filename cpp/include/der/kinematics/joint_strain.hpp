#pragma once

namespace der {

/// Curvature, integrated over the joint between two edges, towards the two directors, and its twist
/// [rad].
template <class T>
struct JointStrainOf {
  T kappa_1 = 0.0;
  T kappa_2 = 0.0;
  T twist = 0.0;
};
using JointStrain = JointStrainOf<double>;

}  // namespace der
