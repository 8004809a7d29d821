#include "der/lanes/member_energies.hpp"

#include <type_traits>

#include "der/core/strided.hpp"
#include "der/core/sum_of.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/registry.hpp"
#include "der/energies/stretch.hpp"

namespace der {
namespace {

using std::sqrt;

template <class T>
Vector2<T> along(Index from, Index to, const MemberVector<T>& positions) {
  return {positions[to] - positions[from], positions[to + 1] - positions[from + 1]};
}

/// Sum over the elements of a kind of `energy(constants, dofs)`, with `constants(member)` for a
/// constant in all lanes.
template <class Kernel, class T, class Energy>
T sum_over(const MemberModel<T>& model, const Energy& energy) {
  const auto& dofs = elements_of<Kernel>(*model.structure().elements).dofs;
  std::array<const typename Kernel::Constants*, to_size(LaneTraits<T>::kCount)> lists;
  for (std::size_t lane = 0; lane < lists.size(); ++lane) {
    lists[lane] = elements_of<Kernel>(*model.models[lane]->elements).constants.data();
  }
  T total = 0.0;
  run_member_loop<T>([&] {
    for (std::size_t e = 0; e < dofs.size(); ++e) {
      const auto constant = [&](double Kernel::Constants::* member) {
        return in_lanes<T>([&](int lane) { return lists[to_size(lane)][e].*member; });
      };
      total += energy(constant, dofs[e]);
    }
  });
  return total;
}

template <class Kernel>
struct Energy;
template <>
struct Energy<Stretch<2>> {
  template <class T>
  static T of(const MemberModel<T>& model, const MemberVector<T>& positions) {
    using C = Stretch<2>::Constants;
    return sum_over<Stretch<2>>(model, [&](const auto& constant, const auto& dofs) -> T {
      const Vector2<T> e = along(dofs[0], dofs[2], positions);
      const StretchResponseOf<T> stretch = stretch_response<T>(
          constant(&C::EA), constant(&C::rest_length), 0.0, sqrt(T(e.squaredNorm())));
      return 0.5 * stretch.tension * stretch.extension;
    });
  }
};
template <class Curvature>
struct Energy<PlanarBend<Curvature>> {
  template <class T>
  static T of(const MemberModel<T>& model, const MemberVector<T>& positions) {
    using C = typename PlanarBend<Curvature>::Constants;
    return sum_over<PlanarBend<Curvature>>(model, [&](const auto& constant, const auto& dofs) -> T {
      return bend_response<Curvature, T>(constant(&C::stiffness_per_length),
                                         constant(&C::rest_kappa),
                                         angle_between<T>(along(dofs[0], dofs[2], positions),
                                                          along(dofs[2], dofs[4], positions)))
          .energy;
    });
  }
};

/// Of any other kind, one by one: there are few.
template <class List>
double energy_of_lane(const List& list, const Configuration& here,
                      const Strided<const double>& positions) {
  using Kernel = typename List::KernelType;
  LocalTerm<Kernel::kDofs> local;
  double total = 0.0;
  for (std::size_t e = 0; e < list.size(); ++e) {
    evaluate_element<Kernel, Derivatives::Energy>(list.constants[e], here,
                                                  gather(list.dofs[e], positions), local);
    total += local.energy;
  }
  return total;
}

template <class Kernel>
constexpr bool kInLanes =
    std::is_same_v<Kernel, Stretch<2>> || std::is_same_v<Kernel, PlanarBend<AngleCurvature>> ||
    std::is_same_v<Kernel, PlanarBend<TangentCurvature>>;

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
      if constexpr (kInLanes<Kernel>) {
        add(Kernel::kTerm, Energy<Kernel>::of(model, positions));
      } else {
        add(Kernel::kTerm, in_lanes<T>([&](int lane) {
              const auto* first = reinterpret_cast<const double*>(positions.data());
              return energy_of_lane(std::get<List>(model.models[to_size(lane)]->elements->lists),
                                    members.controls.here()[to_size(lane)],
                                    {first + lane, LaneTraits<T>::kCount});
            }));
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

template std::array<Energies, 4> member_energies(const Members<FourLanes>&,
                                                 const MemberVector<FourLanes>&,
                                                 const MemberVector<FourLanes>&);
template std::array<Energies, 8> member_energies(const Members<EightLanes>&,
                                                 const MemberVector<EightLanes>&,
                                                 const MemberVector<EightLanes>&);

}  // namespace der
