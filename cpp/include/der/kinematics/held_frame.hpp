#pragma once

#include <Eigen/Geometry>

#include "der/core/types.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// The section frame that a clamp holds: the drawn one, rotated about an axis fixed in space, then
/// turned about its tangent. Both rotations follow controls.
struct HeldFrame {
  SectionFrame drawn;
  Vec3 axis = Vec3::UnitZ();  ///< unit vector
  Index rotation = -1;        ///< control: angle about the axis [rad]; -1: none
  Index twist = -1;           ///< control: angle about the tangent [rad]; -1: none

  /// The frame rotated about the axis by `angle` [rad], without the turn about the tangent, which
  /// joints count separately, whole turns included.
  [[nodiscard]] SectionFrame rotated(double angle) const {
    const Eigen::AngleAxisd turn(angle, axis);
    return SectionFrame::of(turn * drawn.tangent, turn * drawn.first);
  }
  [[nodiscard]] SectionFrame untwisted(const Vector& controls) const {
    return rotation < 0 ? drawn : rotated(controls[rotation]);
  }
  [[nodiscard]] Vec3 tangent(const Vector& controls) const {
    if (rotation < 0) return drawn.tangent;
    return Eigen::AngleAxisd(controls[rotation], axis) * drawn.tangent;
  }
  [[nodiscard]] double twist_angle(const Vector& controls) const {
    return twist < 0 ? 0.0 : controls[twist];
  }
};

/// The point about which the edge next to a clamp turns, on the held tangent (supports/clamp.hpp).
struct SpatialPivot {
  static constexpr int kDimension = 3;

  double distance = 0.0;  ///< [m] along the tangent, negative behind the node; 0: the node itself
  HeldFrame held;

  /// From the node to the pivot [m].
  [[nodiscard]] Vec3 offset(const Vector& controls) const {
    if (distance == 0.0) return Vec3::Zero();
    return distance * held.tangent(controls);
  }
  /// The same in the initial shape, where no clamp has turned yet.
  [[nodiscard]] Vec3 drawn_offset() const { return distance * held.drawn.tangent; }
};

}  // namespace der
