#include "der/assembly/structure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <type_traits>

#include "der/energies/registry.hpp"

namespace der {
namespace {

std::string difference(const RodMesh& here, const RodMesh& other) {
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
    return fmt::format("its model is '{}' in place of '{}': write 'model: {}', which can have both",
                       here.name, other.name,
                       here.num_dofs() < other.num_dofs() ? other.name : here.name);
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

/// How a message calls the elements of a kind, and why two scenes may have different ones.
struct Difference {
  const char* what;
  const char* why;
};

template <class Kernel>
constexpr Difference kDifference =
    Kernel::kTerm == EnergyTerm::Spring
        ? Difference{"its springs hold other nodes or edges",
                     "a spring acts there in one of the two scenes alone"}
    : Kernel::kTerm == EnergyTerm::Load
        ? Difference{"its moments act on other edges",
                     "a moment acts there in one of the two scenes alone"}
        : Difference{"its rods stretch or bend by other elements",
                     "there, in one of the two scenes alone, a stiffness is zero, a support holds "
                     "or turns the rod, a moment or a spring acts, or a corner is drawn, or the "
                     "'curvature' of the rod is another one"};
template <int Dim>
constexpr Difference kDifference<Foundation<Dim>>{
    "its foundations hold other edges",
    "a foundation has to begin and end in the same edges, so vary its 'from' and 'to' along with "
    "the length of the rod"};

/// Describes the first element that one of two lists has and the other one has not; empty if there
/// is none.
template <class Kernel>
std::string difference(const ElementList<Kernel>& here, const ElementList<Kernel>& other,
                       const Model& model) {
  const auto [mine, its] =
      std::mismatch(here.dofs.begin(), here.dofs.end(), other.dofs.begin(), other.dofs.end());
  if (mine == here.dofs.end() && its == other.dofs.end()) return {};
  const Index dof = (mine != here.dofs.end() ? *mine : *its).front();
  const NodePlace place = place_of(model, model.dofs.node_of(dof));
  return fmt::format("{}, first at node {} of rod '{}': {}", kDifference<Kernel>.what, place.place,
                     place.rod, kDifference<Kernel>.why);
}

std::string difference_of_elements(const Model& here, const Model& other) {
  std::string found;
  const auto compare = [&](const auto& list) {
    using List = std::decay_t<decltype(list)>;
    if (found.empty()) found = difference(list, std::get<List>(other.elements->lists), here);
  };
  for_each_list(*here.elements, compare);
  return found;
}

bool same_couplings(const Mass& here, const Mass& other) {
  return std::equal(
      here.coupling.begin(), here.coupling.end(), other.coupling.begin(), other.coupling.end(),
      [](const MassCoupling& a, const MassCoupling& b) { return a.a == b.a && a.b == b.b; });
}

/// Whether the same elements have an actuated rest shape.
bool same_actuation(const Model& here, const Model& other) {
  return std::equal(here.rods.begin(), here.rods.end(), other.rods.begin(),
                    [](const RodMesh& a, const RodMesh& b) {
                      return a.natural_strain_entries.edges == b.natural_strain_entries.edges &&
                             a.natural_strain_entries.cells == b.natural_strain_entries.cells &&
                             a.natural_strain_entries.legs == b.natural_strain_entries.legs;
                    });
}

/// Whether the same elements have internal damping.
bool same_damping(const Model& here, const Model& other) {
  bool same = true;
  for_each_list(*here.elements, [&](const auto& list) {
    const auto& damped = std::get<std::decay_t<decltype(list)>>(other.elements->lists).damped;
    same = same && std::equal(list.damped.begin(), list.damped.end(), damped.begin(), damped.end(),
                              [](const DampedElement& a, const DampedElement& b) {
                                return a.element == b.element;
                              });
  });
  return same;
}

}  // namespace

std::string structural_difference(const Model& here, const Model& other) {
  std::string found = difference_of_rods(here, other);
  if (!found.empty()) return found;
  if (here.dofs.free() != other.dofs.free()) return "its supports hold other components";
  if (!same_actuation(here, other)) return "its actuations act on other parts of the rods";
  found = difference_of_elements(here, other);
  if (!found.empty()) return found;
  if (!same_damping(here, other)) return "a time of internal damping is zero in one of the two";
  if (!same_couplings(here.mass, other.mass)) return "the mass of a rod is zero in one of the two";
  return {};
}

}  // namespace der
