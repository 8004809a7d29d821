#pragma once

#include <type_traits>

#include "der/core/types.hpp"
#include "der/model/leg.hpp"

namespace der {

/// Calls use(edges, joints, from_start) for each end cell of a leg, with the numbers of its edges
/// and joints as constants: one at each end that has a joint, or one for all of a leg of one or two
/// cells between two joints.
template <class Use>
void for_each_end_cell(const Leg& leg, const Use& use) {
  using One = std::integral_constant<int, 1>;
  using Two = std::integral_constant<int, 2>;
  const bool at_start = leg.start.rotation >= 0;
  const bool at_end = leg.end.rotation >= 0;
  const Index cells = leg.num_cells();
  if (at_start && at_end && cells <= 2) {
    cells == 1 ? use(One{}, Two{}, true) : use(Two{}, Two{}, true);
    return;
  }
  for (const bool from_start : {true, false}) {
    if (!(from_start ? at_start : at_end)) continue;
    cells == 1 ? use(One{}, One{}, from_start) : use(Two{}, One{}, from_start);
  }
}

}  // namespace der
