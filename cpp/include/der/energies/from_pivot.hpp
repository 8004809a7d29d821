#pragma once

#include <tuple>

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/held_frame.hpp"
#include "der/kinematics/pivot.hpp"

namespace der {

/// FromPivot::Values: those of the element, and the offsets [m] from its outer nodes to the pivots.
template <class Kernel, class PivotKind, class T>
struct FromPivotValues {
  using Offset = Eigen::Matrix<T, PivotKind::kDimension, 1>;
  typename Kernel::template Values<T> element;
  Offset first;
  Offset last;
  auto fields() { return std::tuple_cat(element.fields(), std::tie(first, last)); }
};

/// An element whose first or last node is clamped, so that its edge starts from the pivot there. As
/// a pivot moves with its node, the derivatives are those of the element itself. `Kernel` says how
/// many nodes it has; their coordinates come first, angles of edges behind them.
template <class Kernel, class PivotKind = Pivot>
struct FromPivot {
  using Element = Kernel;
  static constexpr int kDofs = Kernel::kDofs;
  static constexpr int kNodes = Kernel::kNodes;
  static constexpr EnergyTerm kTerm = Kernel::kTerm;
  struct Constants {
    typename Kernel::Constants element;
    PivotKind first;
    PivotKind last;
  };

  template <class T>
  using Offset = Eigen::Matrix<T, PivotKind::kDimension, 1>;
  template <class T>
  using Values = FromPivotValues<Kernel, PivotKind, T>;
  /// For kernels that have values (energies/element_list.hpp).
  static auto values(const Constants& c, const Vector& controls) {
    return Values<double>{Kernel::values(c.element, controls), c.first.offset(controls),
                          c.last.offset(controls)};
  }

  /// The coordinates that the element sees.
  template <class T = double>
  static Eigen::Matrix<T, kDofs, 1> from_pivots(const Offset<T>& first, const Offset<T>& last,
                                                const Eigen::Matrix<T, kDofs, 1>& x) {
    constexpr int dimension = PivotKind::kDimension;
    Eigen::Matrix<T, kDofs, 1> moved = x;
    moved.template head<dimension>() += first;
    moved.template segment<dimension>(dimension * (kNodes - 1)) += last;
    return moved;
  }
  static Eigen::Matrix<double, kDofs, 1> from_pivots(const Constants& c, const Vector& controls,
                                                     const Eigen::Matrix<double, kDofs, 1>& x) {
    return from_pivots<double>(c.first.offset(controls), c.last.offset(controls), x);
  }

  template <Derivatives D, class T>
  static void evaluate(const Values<T>& c, const Eigen::Matrix<T, kDofs, 1>& x,
                       LocalTerm<kDofs, T>& out) {
    Kernel::template evaluate<D, T>(c.element, from_pivots<T>(c.first, c.last, x), out);
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
