#pragma once

#include <cstddef>

#include "der/energies/effective_edge.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/stretch.hpp"

namespace der {

/// Calls use(edge, constants) for each edge that stretches, `constants` being those of Stretch<2>.
template <class Use>
void for_each_stretched_edge(const ElementLists& elements, const Use& use) {
  const auto& plain = elements_of<Stretch<2>>(elements);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    use(EffectiveEdge{plain.dofs[i], {}, {}}, plain.constants[i]);
  }
  const auto& clamped = elements_of<FromPivot<Stretch<2>>>(elements);
  for (std::size_t i = 0; i < clamped.size(); ++i) {
    const auto& c = clamped.constants[i];
    use(EffectiveEdge{clamped.dofs[i], c.first, c.last}, c.element);
  }
}

}  // namespace der
