#include "der/energies/registry.hpp"

#include <utility>

#include "der/energies/elements_of.hpp"
#include "energies/every_kind.hpp"

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
struct Accessors {
  static constexpr std::pair<ElementList<Kernel>& (*)(ElementLists&),
                             const ElementList<Kernel>& (*)(const ElementLists&)>
      value{&elements_of<Kernel>, &elements_of<Kernel>};
};

[[gnu::used]] constexpr auto kAccessors = of_every_kind<Accessors>();

}  // namespace
}  // namespace der
