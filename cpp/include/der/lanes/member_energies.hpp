#pragma once

#include <array>

#include "der/lanes/members.hpp"
#include "der/model/energies.hpp"

namespace der {

/// Energies of several members with these velocities: of each, to the last bit, those of `energies`
/// (model/state.hpp).
template <class T>
std::array<Energies, to_size(LaneTraits<T>::kCount)> member_energies(
    const Members<T>& members, const MemberVector<T>& positions, const MemberVector<T>& velocities);

}  // namespace der
