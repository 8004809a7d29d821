#include "der/assembly/structure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include "der/energies/registry.hpp"

namespace der {
namespace {

std::string difference(const RodLayout& here, const RodLayout& other) {
  if (here.name != other.name) {
    return fmt::format("it has a rod '{}' in place of '{}'", here.name, other.name);
  }
  if (here.nodes.size() != other.nodes.size()) {
    return fmt::format("its rod '{}' has {} nodes in place of {}", here.name, here.nodes.size(),
                       other.nodes.size());
  }
  if (here.closed != other.closed) {
    return fmt::format("its rod '{}' is {}", here.name, here.closed ? "closed" : "open");
  }
  return {};
}

std::string difference_of_rods(const Model& here, const Model& other) {
  if (here.name != other.name) {
    return fmt::format("its model is '{}' in place of '{}'", here.name, other.name);
  }
  if (here.rods.size() != other.rods.size()) {
    return fmt::format("it has {} rods in place of {}", here.rods.size(), other.rods.size());
  }
  for (std::size_t i = 0; i < here.rods.size(); ++i) {
    std::string found = difference(here.rods[i], other.rods[i]);
    if (!found.empty()) return found;
  }
  return {};
}

template <std::size_t... I>
bool same_dofs(const ElementLists::Lists& here, const ElementLists::Lists& other,
               std::index_sequence<I...> /*kinds*/) {
  return ((std::get<I>(here).dofs == std::get<I>(other).dofs) && ...);
}

bool same_elements(const Model& here, const Model& other) {
  constexpr auto kKinds = std::make_index_sequence<std::tuple_size_v<ElementLists::Lists>>{};
  return same_dofs(here.elements->lists, other.elements->lists, kKinds);
}

bool same_couplings(const Mass& here, const Mass& other) {
  return std::equal(
      here.coupling.begin(), here.coupling.end(), other.coupling.begin(), other.coupling.end(),
      [](const MassCoupling& a, const MassCoupling& b) { return a.a == b.a && a.b == b.b; });
}

/// Whether the same elements have an actuated rest shape.
bool same_actuation(const Model& here, const Model& other) {
  return std::equal(here.rods.begin(), here.rods.end(), other.rods.begin(),
                    [](const RodLayout& a, const RodLayout& b) {
                      return a.rest_entries.edges == b.rest_entries.edges &&
                             a.rest_entries.cells == b.rest_entries.cells;
                    });
}

}  // namespace

std::string structural_difference(const Model& here, const Model& other) {
  std::string found = difference_of_rods(here, other);
  if (!found.empty()) return found;
  if (here.dofs.free() != other.dofs.free()) return "its supports hold other components";
  if (!same_actuation(here, other)) return "its actuations act on other parts of the rods";
  if (!same_elements(here, other)) {
    return "its rods have other elements: a stiffness is zero, or a clamp, a spring or a moment "
           "acts, in one of the two scenes alone";
  }
  if (!same_couplings(here.mass, other.mass)) return "the mass of a rod is zero in one of the two";
  return {};
}

}  // namespace der
