#pragma once

#include <algorithm>
#include <tuple>

#include "der/core/types.hpp"
#include "der/model/fields.hpp"

namespace der {

/// A function of time that replaces the table of a control once a program has set it: linear
/// between two values at two times, constant before and after.
struct Ramp {
  Index control = 0;
  double start = 0.0;  ///< [s]
  double end = 0.0;    ///< [s]
  double from = 0.0;   ///< until `start`, in the unit of the control
  double to = 0.0;     ///< from `end` on
  /// The way before `start`, where a program sets a motion step by step: the values one and two
  /// steps before it, and the length of these steps [s]; 0: not known.
  double step = 0.0;
  double before = 0.0;
  double earlier = 0.0;

  [[nodiscard]] double at(double t) const {
    if (t >= end) return to;
    if (t <= start) return from;
    return from + (t - start) / (end - start) * (to - from);
  }
  /// The value at a time up to two steps before `start` as well.
  [[nodiscard]] double past(double t) const {
    if (t >= start || step == 0.0) return at(t);
    const double steps = (start - t) / step;
    if (steps <= 1.0) return from + steps * (before - from);
    return before + std::min(steps - 1.0, 1.0) * (earlier - before);
  }

  static constexpr auto fields() {
    return std::make_tuple(field("control", "", &Ramp::control, Values::NotNegative),
                           field("start", "s", &Ramp::start, Values::Finite),
                           field("end", "s", &Ramp::end, Values::Finite),
                           field("from", "", &Ramp::from, Values::Finite),
                           field("to", "", &Ramp::to, Values::Finite),
                           field("step", "s", &Ramp::step, Values::NotNegative),
                           field("before", "", &Ramp::before, Values::Finite),
                           field("earlier", "", &Ramp::earlier, Values::Finite));
  }
};
static_assert(lists_all_members<Ramp>());

}  // namespace der
