#pragma once

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/held_frame.hpp"
#include "der/kinematics/pivot.hpp"

namespace der {

/// An element whose first or last node is clamped, so that its edge starts from the pivot there. As
/// a pivot moves with its node, the derivatives are those of the element itself. `Kernel` says how
/// many nodes it has; their coordinates come first, angles of edges behind them.
template <class Kernel, class PivotKind = Pivot>
struct FromPivot {
  static constexpr int kDofs = Kernel::kDofs;
  static constexpr int kNodes = Kernel::kNodes;
  static constexpr EnergyTerm kTerm = Kernel::kTerm;
  struct Constants {
    typename Kernel::Constants element;
    PivotKind first;
    PivotKind last;
  };

  /// The coordinates that the element sees.
  static Eigen::Matrix<double, kDofs, 1> from_pivots(const Constants& c, const Vector& controls,
                                                     const Eigen::Matrix<double, kDofs, 1>& x) {
    constexpr int dimension = PivotKind::kDimension;
    Eigen::Matrix<double, kDofs, 1> moved = x;
    moved.template head<dimension>() += c.first.offset(controls);
    moved.template segment<dimension>(dimension * (kNodes - 1)) += c.last.offset(controls);
    return moved;
  }

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    Kernel::template evaluate<D>(c.element, here, from_pivots(c, here.controls, x), out);
  }
};

template <class Kernel>
using FromSpatialPivot = FromPivot<Kernel, SpatialPivot>;

}  // namespace der
