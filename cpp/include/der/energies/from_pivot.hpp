#pragma once

#include <cmath>

#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// The point about which the edge next to a clamp turns: on the clamped tangent, `distance` from
/// the clamped node (supports/clamp.hpp says why it is not the node itself).
struct Pivot {
  double distance = 0.0;   ///< [m] along the tangent, negative behind the node; 0: the node itself
  double direction = 0.0;  ///< initial angle of the clamped tangent [rad]
  Index rotation = -1;     ///< control that turns the tangent [rad]; -1: none

  /// From the node to the pivot [m], the tangent being turned by `turn` [rad].
  [[nodiscard]] Vec2 offset(double turn) const {
    if (distance == 0.0) return Vec2::Zero();
    return {distance * std::cos(direction + turn), distance * std::sin(direction + turn)};
  }
  [[nodiscard]] double turn(const Configuration& here) const {
    return rotation >= 0 ? here.controls[rotation] : 0.0;
  }
};

/// An element whose first or last node is clamped, so that its edge starts from the pivot there. As
/// a pivot moves with its node, the derivatives are those of the element itself.
template <class Kernel>
struct FromPivot {
  static constexpr int kDofs = Kernel::kDofs;
  static constexpr EnergyTerm kTerm = Kernel::kTerm;
  struct Constants {
    typename Kernel::Constants element;
    Pivot first;
    Pivot last;
  };

  template <Derivatives D>
  static void evaluate(const Constants& c, const Configuration& here,
                       const Eigen::Matrix<double, kDofs, 1>& x, LocalTerm<kDofs>& out) {
    Eigen::Matrix<double, kDofs, 1> moved = x;
    moved.template head<2>() += c.first.offset(c.first.turn(here));
    moved.template tail<2>() += c.last.offset(c.last.turn(here));
    Kernel::template evaluate<D>(c.element, here, moved, out);
  }
};

}  // namespace der
