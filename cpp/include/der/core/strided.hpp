#pragma once

#include <cstddef>

#include "der/core/types.hpp"

namespace der {

/// Numbers that stand in memory at equal distances: those of a vector, or of one lane of a vector
/// of lanes.
template <class Number>
struct Strided {
  Number* first = nullptr;
  std::ptrdiff_t stride = 1;
  Number& operator[](Index i) const { return first[i * stride]; }
};

}  // namespace der
