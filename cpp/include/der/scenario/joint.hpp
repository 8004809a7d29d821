#pragma once

#include <string>
#include <vector>

#include "der/scenario/location.hpp"
#include "der/scenario/mark.hpp"

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

/// Joins rods at a point: at their ends or inside.
struct Joint {
  std::string name;
  std::vector<JointMember> of;  ///< two or more
  JointKind kind = JointKind::Rigid;
  Mark mark;
};

}  // namespace der::scenario
