#pragma once

#include "der/core/types.hpp"

namespace der {

/// The forces of a circulatory load (circulatory_load.hpp) on its local coordinates.
struct CirculatoryTerm {
  /// Coordinates of a point, and the vectors and angles of two edges.
  static constexpr int kMost = 3 + 2 * 4;

  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1> force;  ///< Q [N, or N m for angles]
  /// -dQ/dq, as a part of the derivative of the left side of the equations of motion.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost> tangent;

  void reset(Index size) {
    force.setZero(size);
    tangent.setZero(size, size);
  }
};

/// Elastic energy [J] beside the place of a moment that is due to it.
struct StoredBeside {
  double in_rod = 0.0;      ///< of the rod between the place and what the edges tell
  double in_springs = 0.0;  ///< of springs at the place, beyond that without the moment
};

}  // namespace der
