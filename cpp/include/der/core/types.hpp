#pragma once

#include <Eigen/Core>

namespace der {

/// Dense column vector of run-time length: one entry per degree of freedom unless said otherwise.
using Vector = Eigen::VectorXd;
using Vec2 = Eigen::Vector2d;
using Mat2 = Eigen::Matrix2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// The same of any number type, for kernels that work on lanes (core/lanes.hpp).
template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Vector2 = Eigen::Matrix<T, 2, 1>;
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

/// Integer type of every node, element, degree-of-freedom and matrix-slot index. 32 bits halve the
/// memory traffic of the scatter maps and still reach two thousand million.
using Index = int;

}  // namespace der
