#pragma once

#include <tuple>

namespace der {

/// Curvature, integrated over the vertex between two edges, towards the two directors, and its
/// twist [rad].
template <class T>
struct MaterialCurvatureOf {
  T kappa_1 = 0.0;
  T kappa_2 = 0.0;
  T twist = 0.0;
  auto fields() { return std::tie(kappa_1, kappa_2, twist); }
};
using MaterialCurvature = MaterialCurvatureOf<double>;

}  // namespace der
