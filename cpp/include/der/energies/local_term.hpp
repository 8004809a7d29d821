#pragma once

#include <Eigen/Core>

#include "der/catalog/energy_terms.hpp"

namespace der {

/// How much of an element's energy a kernel must work out. Kernels take it as a template argument,
/// so that a residual evaluation does not pay for a Hessian.
enum class Derivatives { Energy, Gradient, Hessian };

/// Energy of one element [J] with its derivatives by the element's own N coordinates. The kernels
/// fill the members up to the order asked for; of `hessian` only the lower triangle is set.
template <int N, class T = double>
struct LocalTerm {
  T energy = 0.0;
  Eigen::Matrix<T, N, 1> gradient;
  Eigen::Matrix<T, N, N> hessian;
};

}  // namespace der
