#pragma once

#include <cstddef>

#include "der/core/types.hpp"

namespace der {

/// An index as the standard containers want it. Never called with a negative one.
constexpr std::size_t to_size(Index i) { return static_cast<std::size_t>(i); }

}  // namespace der
