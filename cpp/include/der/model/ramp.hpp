#pragma once

#include "der/core/types.hpp"

namespace der {

/// What a control follows in place of its table once a program has set it: from one value to
/// another, linear between two times, constant before and after.
struct Ramp {
  Index control = 0;
  double start = 0.0;  ///< [s]
  double end = 0.0;    ///< [s]
  double from = 0.0;   ///< until `start`, in the unit of the control
  double to = 0.0;     ///< from `end` on

  [[nodiscard]] double at(double t) const {
    if (t >= end) return to;
    if (t <= start) return from;
    return from + (t - start) / (end - start) * (to - from);
  }
};

}  // namespace der
