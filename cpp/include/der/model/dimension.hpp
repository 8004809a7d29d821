#pragma once

#include <type_traits>
#include <utility>

#include "der/model/model.hpp"

namespace der {

/// Calls f with the number of components of a position, 2 or 3, as a constant.
template <class F>
decltype(auto) with_dimension(const Model& model, F&& f) {
  if (model.dimension == 2) return std::forward<F>(f)(std::integral_constant<int, 2>{});
  return std::forward<F>(f)(std::integral_constant<int, 3>{});
}

}  // namespace der
