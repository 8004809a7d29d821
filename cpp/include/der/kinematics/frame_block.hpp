#pragma once

#include "der/core/types.hpp"

namespace der {

/// The values that the state follows for one edge with a section frame, as entries of the controls
/// that elements see: the source tangent and the reference director there, and the reference twists
/// of the vertices at its start and at its end, whole turns included. The blocks of all edges stand
/// at the head of the controls, in the order of the edges.
struct FrameBlock {
  static constexpr Index kSize = 8;
  Index first = 0;  ///< entry of the controls

  static FrameBlock of(Index edge) { return {kSize * edge}; }
  template <class Values>
  [[nodiscard]] Vec3 tangent(const Values& values) const {
    return values.template segment<3>(first);
  }
  template <class Values>
  [[nodiscard]] Vec3 director(const Values& values) const {
    return values.template segment<3>(first + 3);
  }
  /// Entry of the reference twist [rad] of the vertex at the edge's start or end.
  [[nodiscard]] Index twist_at_start() const { return first + 6; }
  [[nodiscard]] Index twist_at_end() const { return first + 7; }
};

}  // namespace der
