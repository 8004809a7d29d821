#pragma once

#include <Eigen/Geometry>

#include "der/core/types.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// The section frame that a clamp holds: the drawn one, rotated about an axis fixed in space, then
/// turned about its tangent. Both rotations follow controls.
///
/// In stages of a step the tangent is not on the circle about the axis on which it turns, but at
/// the mean of what the method integrates (steppers/stage_controls.hpp): within the circle.
struct HeldFrame {
  SectionFrame drawn;
  Vec3 axis = Vec3::UnitZ();  ///< unit vector
  Index rotation = -1;        ///< control: angle about the axis [rad]; -1: none
  Index inset = -1;           ///< control: how far within the circle, over its radius; -1: none
  Index twist = -1;           ///< control: angle about the tangent [rad]; -1: none

  /// The frame rotated about the axis by `angle` [rad], without the turn about the tangent, which
  /// vertices count separately, whole turns included.
  [[nodiscard]] SectionFrame rotated(double angle) const {
    const Eigen::AngleAxisd turn(angle, axis);
    return SectionFrame::of(turn * drawn.tangent, turn * drawn.first);
  }
  [[nodiscard]] SectionFrame untwisted(const Vector& controls) const {
    if (rotation < 0) return drawn;
    const SectionFrame turned = rotated(controls[rotation]);
    if (!is_within(controls)) return turned;
    const Vec3 inner = within(turned.tangent, controls);
    return SectionFrame::of(inner, transport(turned.first, turned.tangent, inner));
  }
  [[nodiscard]] Vec3 tangent(const Vector& controls) const {
    if (rotation < 0) return drawn.tangent;
    const Vec3 turned = Eigen::AngleAxisd(controls[rotation], axis) * drawn.tangent;
    return is_within(controls) ? within(turned, controls) : turned;
  }
  [[nodiscard]] double twist_angle(const Vector& controls) const {
    return twist < 0 ? 0.0 : controls[twist];
  }

 private:
  [[nodiscard]] bool is_within(const Vector& controls) const {
    return inset >= 0 && controls[inset] != 0.0;
  }
  [[nodiscard]] Vec3 within(const Vec3& on_circle, const Vector& controls) const {
    const Vec3 radius = on_circle - axis.dot(on_circle) * axis;
    return (on_circle - controls[inset] * radius).normalized();
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
  [[nodiscard]] Vec3 reference_offset() const { return distance * held.drawn.tangent; }
};

}  // namespace der
