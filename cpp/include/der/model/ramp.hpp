#pragma once

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

  [[nodiscard]] double at(double t) const {
    if (t >= end) return to;
    if (t <= start) return from;
    return from + (t - start) / (end - start) * (to - from);
  }

  static constexpr auto fields() {
    return std::make_tuple(field("control", "", &Ramp::control, Values::NotNegative),
                           field("start", "s", &Ramp::start, Values::Finite),
                           field("end", "s", &Ramp::end, Values::Finite),
                           field("from", "", &Ramp::from, Values::Finite),
                           field("to", "", &Ramp::to, Values::Finite));
  }
};
static_assert(lists_all_members<Ramp>());

}  // namespace der
