#pragma once

#include <cstddef>

#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/planar_moment.hpp"

namespace der {

/// Calls use(dofs, constants) for each moment on an edge of a planar rod, `constants` being those
/// of PlanarMoment.
template <class Use>
void for_each_planar_moment(const ElementLists& elements, const Use& use) {
  const auto& plain = elements_of<PlanarMoment>(elements);
  for (std::size_t i = 0; i < plain.size(); ++i) use(plain.dofs[i], plain.constants[i]);
  const auto& beside_clamps = elements_of<FromPivot<PlanarMoment>>(elements);
  for (std::size_t i = 0; i < beside_clamps.size(); ++i) {
    use(beside_clamps.dofs[i], beside_clamps.constants[i].element);
  }
}

}  // namespace der
