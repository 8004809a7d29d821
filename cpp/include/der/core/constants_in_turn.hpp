#pragma once

#include <cstddef>
#include <utility>

namespace der {

/// Calls use(c) for each constant of an array, in turn, without a loop: compilers keep a loop over
/// the terms of a series, and work out or load each coefficient anew, in each lane.
template <const auto& kConstants, class Use, std::size_t... I>
void for_each_constant(const Use& use, std::index_sequence<I...> /*numbers*/) {
  (use(kConstants[I]), ...);
}
template <const auto& kConstants, class Use>
void for_each_constant(const Use& use) {
  for_each_constant<kConstants>(use, std::make_index_sequence<kConstants.size()>{});
}

}  // namespace der
