#pragma once

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/held_frame.hpp"

namespace der {

/// FromPivot in space: an element whose first or last node is clamped. `Kernel` says how many nodes
/// it has; their coordinates come first, angles of edges behind them.
template <class Kernel>
struct FromSpatialPivot {
  static constexpr int kDofs = Kernel::kDofs;
  static constexpr int kNodes = Kernel::kNodes;
  static constexpr EnergyTerm kTerm = Kernel::kTerm;
  struct Constants {
    typename Kernel::Constants element;
    SpatialPivot first;
    SpatialPivot last;
  };

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    Eigen::Matrix<double, kDofs, 1> moved = x;
    moved.template segment<3>(0) += c.first.offset(here.controls);
    moved.template segment<3>(3 * (kNodes - 1)) += c.last.offset(here.controls);
    Kernel::template evaluate<D>(c.element, here, moved, out);
  }
};

}  // namespace der
