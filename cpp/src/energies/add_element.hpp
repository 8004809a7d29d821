#pragma once

#include <array>

#include "der/core/types.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/registry.hpp"

namespace der {

/// Adds an element to the list of its kind: the plain one, or that of elements between the pivots
/// of clamps. Returns its number there.
template <class Kernel, class PivotKind>
Index add_element(const std::array<Index, Kernel::kDofs>& dofs,
                  const typename Kernel::Constants& constants, const PivotKind& first,
                  const PivotKind& last, ElementLists& elements) {
  const auto add = [&](auto& list, const auto& all) {
    list.add(dofs, all);
    return static_cast<Index>(list.size()) - 1;
  };
  if (first.distance == 0.0 && last.distance == 0.0) {
    return add(elements_of<Kernel>(elements), constants);
  }
  using Pivoted = FromPivot<Kernel, PivotKind>;
  return add(elements_of<Pivoted>(elements), typename Pivoted::Constants{constants, first, last});
}

}  // namespace der
