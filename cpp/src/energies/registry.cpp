#include "der/energies/registry.hpp"

#include <tuple>
#include <utility>

#include "der/energies/elements_of.hpp"

namespace der {

std::vector<CirculatoryLoad>& circulatory_loads(ElementLists& elements) {
  return elements.circulatory;
}

const std::vector<CirculatoryLoad>& circulatory_loads(const ElementLists& elements) {
  return elements.circulatory;
}

template <class Kernel>
ElementList<Kernel>& elements_of(ElementLists& elements) {
  return std::get<ElementList<Kernel>>(elements.lists);
}

template <class Kernel>
const ElementList<Kernel>& elements_of(const ElementLists& elements) {
  return std::get<ElementList<Kernel>>(elements.lists);
}

namespace {

template <class Kernel>
using Accessors = std::pair<ElementList<Kernel>& (*)(ElementLists&),
                            const ElementList<Kernel>& (*)(const ElementLists&)>;

template <class... Kernels>
constexpr auto accessors_of(const std::tuple<ElementList<Kernels>...>* /*lists*/) {
  return std::tuple{Accessors<Kernels>{&elements_of<Kernels>, &elements_of<Kernels>}...};
}

// Instantiates both functions for every kernel.
[[gnu::used]] constexpr auto kAccessors =
    accessors_of(static_cast<const ElementLists::Lists*>(nullptr));

}  // namespace
}  // namespace der
