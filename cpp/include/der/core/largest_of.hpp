#pragma once

#include <array>
#include <cstddef>

#include "der/core/index.hpp"
#include "der/core/lanes.hpp"
#include "der/core/types.hpp"

namespace der {

/// The largest magnitude of value(0) .. value(size - 1), called in this order, in each lane; NaN if
/// one of them is NaN. In lanes there are four parts, which need not wait for one another; loops
/// over one number at a time are left to the compiler.
template <class T, class Value>
T largest_of(Index size, const Value& value) {
  constexpr Index kParts = LaneTraits<T>::kCount == 1 ? 1 : 4;
  std::array<LargestMagnitude<T>, to_size(kParts)> parts;
  Index i = 0;
  for (; i + kParts <= size; i += kParts) {
    for (Index part = 0; part < kParts; ++part) parts[to_size(part)].see(value(i + part));
  }
  for (; i < size; ++i) parts[0].see(value(i));
  for (Index part = 1; part < kParts; ++part) parts[0].see(parts[to_size(part)].value());
  return parts[0].value();
}

}  // namespace der
