#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/direction_angle.hpp"

namespace der {

// The number type is named at the call, or is `double`: arguments may be any expressions.

template <class T>
struct PlanarVector {
  using type = Vector2<T>;
};
template <class T>
using PlanarVectorOf = typename PlanarVector<T>::type;

/// Rotates a planar vector by +90 degrees.
template <class T = double>
Vector2<T> perpendicular(const PlanarVectorOf<T>& v) {
  return {-v.y(), v.x()};
}

/// z component of the cross product of two planar vectors.
template <class T = double>
T cross(const PlanarVectorOf<T>& a, const PlanarVectorOf<T>& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Signed angle from `a` to `b`, in (-pi, pi]; lengths do not matter.
template <class T = double>
T angle_between(const PlanarVectorOf<T>& a, const PlanarVectorOf<T>& b) {
  return direction_angle(T(a.dot(b)), cross<T>(a, b));
}

/// Gradient [1/m] of the direction angle of a planar edge vector `e`: perpendicular(e) / |e|^2.
template <class T = double>
Vector2<T> direction_gradient(const PlanarVectorOf<T>& e, const T& inverse_squared_length) {
  return inverse_squared_length * perpendicular<T>(e);
}

/// Hessian [1/m^2] of the direction angle of a planar edge vector `e`, with `gradient` from above:
/// -(t n' + n t') / |e|^2, t and n the unit tangent and normal. Symmetric and traceless.
template <class T = double>
Eigen::Matrix<T, 2, 2> direction_hessian(const PlanarVectorOf<T>& e,
                                         const PlanarVectorOf<T>& gradient,
                                         const T& inverse_squared_length) {
  const T xx = -2.0 * inverse_squared_length * e.x() * gradient.x();
  const T xy = -inverse_squared_length * (e.x() * gradient.y() + e.y() * gradient.x());
  Eigen::Matrix<T, 2, 2> hessian;
  hessian << xx, xy, xy, -xx;
  return hessian;
}

}  // namespace der
