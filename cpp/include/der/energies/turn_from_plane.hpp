#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// How far a section is turned out of the x-y plane about an axis p in it: psi = v . (p x z), where
/// v is the vector of the section that points along z while the rod lies in the plane. A rotation
/// omega of a section that lies there makes psi = omega . p of it, to first order.
struct TurnFromPlane {
  double psi = 0.0;
  Vec3 axis = Vec3::Zero();    ///< a rotation omega changes psi by omega . axis
  Mat3 change = Mat3::Zero();  ///< of the axis, without its antisymmetric part (set_edge_moment)

  /// `upright`: components of v towards the two directors.
  TurnFromPlane(const SectionFrame& section, const Vec2& upright, const Vec2& about) {
    const Vec3 v = upright[0] * section.first + upright[1] * section.second;
    const Vec3 across(about.y(), -about.x(), 0.0);  // p x z
    psi = v.dot(across);
    axis = v.cross(across);
    change = 0.5 * (v * across.transpose() + across * v.transpose());
    change.diagonal().array() -= psi;
  }

  /// The change by omega of the moment k * turn * axis [N m], in the same sense; `turn` is psi,
  /// with what other sections add to it.
  [[nodiscard]] Mat3 stiffness(double k, double turn) const {
    return k * (axis * axis.transpose() + turn * change);
  }
};

}  // namespace der
