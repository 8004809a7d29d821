#pragma once

#include "der/scenario/mark.hpp"

namespace der::scenario {

/// The value of `at:`: a place along a rod's rest length.
struct Location {
  enum class Kind { Start, Middle, End, All, ArcLength, Node };
  Kind kind = Kind::Start;
  double arc_length = 0.0;  ///< [m], for Kind::ArcLength
  int node = 0;             ///< 0-based, for Kind::Node; negative counts from the end
  Mark mark;
};

}  // namespace der::scenario
