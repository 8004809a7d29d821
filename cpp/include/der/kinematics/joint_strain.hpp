#pragma once

#include <tuple>

namespace der {

/// Curvature, integrated over the joint between two edges, towards the two directors, and its twist
/// [rad].
template <class T>
struct JointStrainOf {
  T kappa_1 = 0.0;
  T kappa_2 = 0.0;
  T twist = 0.0;
  auto fields() { return std::tie(kappa_1, kappa_2, twist); }
};
using JointStrain = JointStrainOf<double>;

}  // namespace der
