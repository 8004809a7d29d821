#pragma once

#include <tuple>

#include "der/energies/registry.hpp"

namespace der {

/// `Of<Kernel>::value` for every kind of element. A constant of it that is [[gnu::used]] compiles
/// the functions that these values point to.
template <template <class> class Of, class... Kernels>
constexpr auto of_every_kind(const std::tuple<ElementList<Kernels>...>* /*lists*/) {
  return std::tuple{Of<Kernels>::value...};
}
template <template <class> class Of>
constexpr auto of_every_kind() {
  return of_every_kind<Of>(static_cast<const ElementLists::Lists*>(nullptr));
}

}  // namespace der
