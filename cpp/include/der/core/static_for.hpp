#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace der {

template <std::size_t N, class Use, std::size_t... I>
void for_each_constant(const std::array<double, N>& constants, const Use& use,
                       std::index_sequence<I...> /*numbers*/) {
  (use(constants[I]), ...);
}

/// Calls use(c) for each constant of an array, in turn, without a loop: compilers keep a loop over
/// the terms of a series, and work out or load each coefficient anew, in each lane.
template <std::size_t N, class Use>
void for_each_constant(const std::array<double, N>& constants, const Use& use) {
  for_each_constant(constants, use, std::make_index_sequence<N>());
}

}  // namespace der
