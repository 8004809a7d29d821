#pragma once

#include <optional>
#include <string>
#include <vector>

#include "der/scenario/location.hpp"
#include "der/scenario/mark.hpp"
#include "der/scenario/series.hpp"

namespace der::scenario {

enum class JointKind {
  Rigid,  ///< the rods keep the angles between them
  Hinge,  ///< each rod turns freely about the others, in a plane
  Ball,   ///< the same in space
};

inline const char* in_words(JointKind kind) {
  switch (kind) {
    case JointKind::Hinge:
      return "hinge";
    case JointKind::Ball:
      return "ball";
    default:
      return "rigid joint";
  }
}

/// A rod at one of its places.
struct JointMember {
  std::string rod;
  Location at;
};

/// A spring between the two sides of a hinge.
struct HingeSpring {
  double rotational_stiffness = 0.0;  ///< [N m/rad]
};

/// How a hinge is driven.
struct HingeMotion {
  /// Of its second rod against the first one, from that at which they are drawn [rad].
  Series angle;
};

/// Joins rods at a point: at their ends or inside.
struct Joint {
  std::string name;
  std::vector<JointMember> of;  ///< two or more
  JointKind kind = JointKind::Rigid;
  std::optional<HingeSpring> spring;     ///< of a hinge of two rods, as is the damping
  double damping = 0.0;                  ///< moment per rate of the angle [N m s/rad]
  std::optional<HingeMotion> prescribe;  ///< likewise: it is driven
  Mark mark;

  [[nodiscard]] bool has_sides() const { return spring || damping > 0.0; }
  /// Whether one rotation turns all rods; a driven hinge turns the second one further.
  [[nodiscard]] bool shares_rotation() const { return kind == JointKind::Rigid || prescribe; }
};

}  // namespace der::scenario
