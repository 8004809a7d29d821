#pragma once

#include <cmath>

#include "der/core/lanes.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {

// The change that PredictedTension makes in the matrix of an edge: in `double`, or for members in
// lanes.

/// A stiffness [N/m] across an edge vector.
template <class T>
Eigen::Matrix<T, 2, 2> stiffness_across(const Vector2<T>& e, const T& length, const T& stiffness) {
  const Vector2<T> normal = perpendicular<T>(e) / length;
  return stiffness * normal * normal.transpose();
}
template <class T>
Matrix3<T> stiffness_across(const Vector3<T>& e, const T& length, const T& stiffness) {
  const Vector3<T> tangent = e / length;
  return stiffness * (Matrix3<T>::Identity() - tangent * tangent.transpose());
}

/// Tension [N] that a `change` of an edge's vector from `before` predicts to first order, less that
/// of the vector `here`.
template <class T, int Dim>
T excess_tension(const Eigen::Matrix<T, Dim, 1>& before, const Eigen::Matrix<T, Dim, 1>& change,
                 const Eigen::Matrix<T, Dim, 1>& here, const T& EA, const T& rest_length) {
  using std::sqrt;
  const T length = sqrt(T(before.squaredNorm()));
  const T predicted = length + before.dot(change) / length;
  return EA * (predicted - sqrt(T(here.squaredNorm()))) / rest_length;
}

}  // namespace der
