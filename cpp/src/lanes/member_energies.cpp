#include "der/lanes/member_energies.hpp"

#include <type_traits>

#include "der/core/strided.hpp"
#include "der/core/sum_of.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/lane_values.hpp"
#include "der/energies/registry.hpp"

namespace der {
namespace {

/// The energies of all elements of a kind [J], of each member.
template <class Kernel, class T>
T energy_in_lanes(const Members<T>& members, const MemberVector<T>& positions) {
  const MemberModel<T>& model = members.model;
  const auto& dofs = elements_of<Kernel>(*model.structure().elements).dofs;
  std::array<const typename Kernel::Constants*, to_size(LaneTraits<T>::kCount)> lists;
  for (std::size_t lane = 0; lane < lists.size(); ++lane) {
    lists[lane] = elements_of<Kernel>(*model.models[lane]->elements).constants.data();
  }
  T total = 0.0;
  run_member_loop<T>([&] {
    LocalTerm<Kernel::kDofs, T> local;
    for (std::size_t e = 0; e < dofs.size(); ++e) {
      const auto values = values_in_lanes<Kernel, T>([&](int lane) {
        return Kernel::values(lists[to_size(lane)][e],
                              members.controls.here()[to_size(lane)].controls);
      });
      Kernel::template evaluate<Derivatives::Energy, T>(values, gather<T>(dofs[e], positions),
                                                        local);
      total += local.energy;
    }
  });
  return total;
}

/// The same of any other kind, one member after the other.
template <class Kernel, class T>
T energy_one_by_one(const Members<T>& members, const MemberVector<T>& positions) {
  return in_lanes<T>([&](int lane) {
    const auto* first = reinterpret_cast<const double*>(positions.data());
    return element_energy(elements_of<Kernel>(*members.model.models[to_size(lane)]->elements),
                          members.controls.here()[to_size(lane)],
                          Strided<const double>{first + lane, LaneTraits<T>::kCount});
  });
}

}  // namespace

template <class T>
std::array<Energies, to_size(LaneTraits<T>::kCount)> member_energies(
    const Members<T>& members, const MemberVector<T>& positions,
    const MemberVector<T>& velocities) {
  const MemberModel<T>& model = members.model;
  std::array<Energies, to_size(LaneTraits<T>::kCount)> result;
  const auto add = [&](EnergyTerm term, const T& energy) {
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
      result[to_size(lane)][term] += energy.lane(lane);
    }
  };
  for_each_list(*model.structure().elements, [&](const auto& structure) {
    using List = std::decay_t<decltype(structure)>;
    using Kernel = typename List::KernelType;
    if constexpr (is_recorded(Kernel::kTerm)) {
      if (structure.size() == 0) return;
      if constexpr (GoesInLanes<Kernel>::value) {
        add(Kernel::kTerm, energy_in_lanes<Kernel>(members, positions));
      } else {
        add(Kernel::kTerm, energy_one_by_one<Kernel>(members, positions));
      }
    }
  });
  T kinetic = 0.0;
  T gravity = members.controls.driven_gravity_energy(positions);
  run_member_loop<T>([&] {
    T twice = sum_of<T>(velocities.size(),
                        [&](Index i) { return velocities[i] * (model.lumped[i] * velocities[i]); });
    const auto& couplings = model.structure().mass.coupling;
    for (std::size_t i = 0; i < couplings.size(); ++i) {
      const T difference = velocities[couplings[i].a] - velocities[couplings[i].b];
      twice -= model.coupling[static_cast<Index>(i)] * difference * difference;
    }
    kinetic = 0.5 * twice;
    gravity -=
        sum_of<T>(positions.size(), [&](Index i) { return model.gravity_force[i] * positions[i]; });
  });
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    result[to_size(lane)][EnergyTerm::Kinetic] = kinetic.lane(lane);
    result[to_size(lane)][EnergyTerm::Gravity] = gravity.lane(lane);
  }
  return result;
}

#define DER_INSTANTIATE(T)                                                       \
  template std::array<Energies, to_size(LaneTraits<T>::kCount)> member_energies( \
      const Members<T>&, const MemberVector<T>&, const MemberVector<T>&);
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
