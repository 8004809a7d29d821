#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <vector>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "der/energies/strain_rate.hpp"
#include "der/energies/viscous_term.hpp"
#include "der/model/model.hpp"

namespace der {

/// The elements of a model that act on some of its degrees of freedom.
class ActingElements {
 public:
  ActingElements() = default;
  /// Those on the degrees of freedom for which `acts(dof)` is true.
  template <class Acts>
  ActingElements(const Model& model, const Acts& acts) {
    std::size_t kind = 0;
    for_each_list(*model.elements, [&](const auto& list) {
      for (std::size_t e = 0; e < list.size(); ++e) {
        const auto& dofs = list.dofs[e];
        if (std::any_of(dofs.begin(), dofs.end(), acts)) numbers_[kind].push_back(e);
      }
      ++kind;
    });
  }

  /// Calls `visit(kernel, constants, dofs, coordinates, gradient)` for each of them.
  template <class Visit>
  void for_each_gradient(const Model& model, const Configuration& here, Visit&& visit) const {
    std::size_t kind = 0;
    for_each_list(*model.elements, [&](const auto& list) {
      using Kernel = typename std::decay_t<decltype(list)>::KernelType;
      LocalTerm<Kernel::kDofs> local;
      for (const std::size_t e : numbers_[kind]) {
        const auto coordinates = gather(list.dofs[e], here.coordinates);
        evaluate_element<Kernel, Derivatives::Gradient>(list.constants[e], here, coordinates,
                                                        local);
        visit(Kernel{}, list.constants[e], list.dofs[e], coordinates, local.gradient);
      }
      ++kind;
    });
  }

  /// The same for those with internal damping: the gradient is that of their viscous forces.
  template <class Visit>
  void for_each_viscous_gradient(const Model& model, const Moving& moving, Visit&& visit) const {
    std::size_t kind = 0;
    for_each_list(*model.elements, [&](const auto& list) {
      using Kernel = typename std::decay_t<decltype(list)>::KernelType;
      const std::vector<std::size_t>& acting = numbers_[kind++];
      if constexpr (StrainRate<Kernel>::kExists) {
        for (const DampedElement& damped : list.damped) {
          const std::size_t e = damped.element;
          if (!std::binary_search(acting.begin(), acting.end(), e)) continue;
          visit(Kernel{}, list.constants[e], list.dofs[e],
                gather(list.dofs[e], moving.here.coordinates),
                viscous_term(list, damped, moving).gradient);
        }
      }
    });
  }

 private:
  std::array<std::vector<std::size_t>, std::tuple_size_v<ElementLists::Lists>> numbers_;
};

}  // namespace der
