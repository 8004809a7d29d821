#pragma once

#include "der/core/types.hpp"

namespace der {

/// [v]x, the matrix of the cross product with v.
template <class T>
Matrix3<T> cross_matrix(const Vector3<T>& v) {
  Matrix3<T> m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

}  // namespace der
