#pragma once

#include <array>
#include <cstddef>

#include "der/core/types.hpp"

namespace der {

/// The controls [rad] by which driven hinges turn the tangents of an element's joints, besides the
/// rotations of the joints, which are the last of its coordinates. -1: none.
template <int Joints>
struct DrivenTangents {
  std::array<Index, Joints> control;

  DrivenTangents() { control.fill(-1); }

  /// The coordinates with what the controls add. `value(control)` is that of a control.
  template <class Value, class Coordinates>
  [[nodiscard]] Coordinates turned(const Value& value, Coordinates x) const {
    for (int k = 0; k < Joints; ++k) {
      const Index number = control[std::size_t(k)];
      if (number >= 0) x[x.size() - Joints + k] += value(number);
    }
    return x;
  }
  template <class Coordinates>
  [[nodiscard]] Coordinates turned_by(const Vector& controls, const Coordinates& x) const {
    return turned([&](Index number) { return controls[number]; }, x);
  }
};

}  // namespace der
