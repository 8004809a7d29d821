#pragma once

#include <Eigen/SparseCore>
#include <algorithm>

#include "der/assembly/pattern.hpp"

namespace der {

/// An Eigen sparse matrix with the positions of `pattern` and values 0.
inline Eigen::SparseMatrix<double, Eigen::ColMajor, Index> compressed_matrix(
    const Pattern& pattern) {
  Eigen::SparseMatrix<double, Eigen::ColMajor, Index> matrix(pattern.size, pattern.size);
  matrix.resizeNonZeros(pattern.nonzeros());
  std::copy(pattern.outer.begin(), pattern.outer.end(), matrix.outerIndexPtr());
  std::copy(pattern.inner.begin(), pattern.inner.end(), matrix.innerIndexPtr());
  std::fill_n(matrix.valuePtr(), pattern.nonzeros(), 0.0);
  return matrix;
}

}  // namespace der
