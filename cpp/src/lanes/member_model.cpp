#include "der/lanes/member_model.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "der/core/largest_of.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/registry.hpp"
#include "der/model/dimension.hpp"
#include "der/supports/clamp.hpp"

namespace der {
namespace {

using std::sqrt;

template <class T>
MemberVector<T> in_lanes_of(const MemberModels<T>& models, const Vector Model::* member) {
  MemberVector<T> all(static_cast<Index>((models[0]->*member).size()));
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    all.set_lane(lane, models[to_size(lane)]->*member);
  }
  return all;
}

/// `value(model, i)` for i below `count`.
template <class T, class Value>
MemberVector<T> in_lanes_of(const MemberModels<T>& models, std::size_t count, const Value& value) {
  MemberVector<T> all(static_cast<Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    all[static_cast<Index>(i)] =
        in_lanes<T>([&](int lane) { return value(*models[to_size(lane)], i); });
  }
  return all;
}

/// Moments, the work of which is that of their elements.
bool any_element_is_a_load(const Model& model) {
  bool found = false;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (Kernel::kTerm == EnergyTerm::Load) found |= list.size() > 0;
  });
  return found;
}

/// The largest of `value(block)`.
template <class T, class Blocks, class Value>
T largest_over_blocks(const Blocks& blocks, const Value& value) {
  T largest = 0.0;
  run_member_loop<T>([&] {
    for (const auto& block : blocks) largest = T::larger_magnitude(largest, value(block));
  });
  return largest;
}

/// The largest magnitude among the numbers of a block.
template <class Block, class T>
T largest_in(const Block& block, const MemberVector<T>& numbers) {
  return largest_of<T>(block.count, [&](Index i) { return numbers[block.first + i]; });
}

}  // namespace

bool suits_lanes(const Model& model) {
  return !model.natural_strain.is_actuated() && !model.viscous && !model.load_variation &&
         model.followed_edges.empty() && circulatory_loads(*model.elements).empty() &&
         !any_element_is_a_load(model) && !any_clamp_turns(model) &&
         std::none_of(model.rods.begin(), model.rods.end(), [](const RodMesh& rod) {
           return rod.closed || !rod.moment_places.empty() || !rod.section_springs.empty();
         });
}

template <class T>
MemberModel<T>::MemberModel(const MemberModels<T>& members)
    : models(members),
      size(in_lanes<T>([&](int lane) { return members[to_size(lane)]->size(); })),
      lumped(in_lanes_of<T>(members, to_size(structure().num_dofs()),
                            [](const Model& model, std::size_t i) {
                              return model.mass.lumped[static_cast<Index>(i)];
                            })),
      coupling(in_lanes_of<T>(
          members, structure().mass.coupling.size(),
          [](const Model& model, std::size_t i) { return model.mass.coupling[i].mass; })),
      damping(in_lanes_of<T>(members, &Model::damping)),
      gravity_force(in_lanes_of<T>(members, &Model::gravity_force)),
      dead_force(in_lanes_of<T>(members, &Model::dead_force)),
      held_places(in_lanes_of<T>(members, structure().held.size(),
                                 [](const Model& model, std::size_t i) {
                                   return model.initial_positions[model.held[i].dof];
                                 })),
      per_squared_length(in_lanes_of<T>(
          members, structure().edges.size(),
          [](const Model& model, std::size_t i) { return model.edges[i].per_squared_length; })) {
  const DofMap& dofs = structure().dofs;
  for (std::size_t k = 0; k < dofs.blocks().size(); ++k) {
    Block& block = blocks.emplace_back();
    block.first = dofs.blocks()[k].first;
    block.count = dofs.blocks()[k].count;
    block.length =
        in_lanes<T>([&](int lane) { return members[to_size(lane)]->dofs.blocks()[k].length; });
    for (Index dof = block.first; dof < block.first + block.count; ++dof) {
      if (dofs.is_free(dof)) block.free.push_back(dof);
    }
  }
}

template <class T>
T MemberModel<T>::largest_motion(const MemberVector<T>& displacement) const {
  return largest_over_blocks<T>(blocks, [&](const auto& block) -> T {
    return block.length * largest_in(block, displacement);
  });
}

template <class T>
T MemberModel<T>::largest_force(const MemberVector<T>& force) const {
  return largest_over_blocks<T>(
      blocks, [&](const auto& block) -> T { return largest_in(block, force) / block.length; });
}

template <class T>
T MemberModel<T>::largest_free_force(const MemberVector<T>& force) const {
  return largest_over_blocks<T>(blocks, [&](const auto& block) -> T {
    const T largest = largest_of<T>(static_cast<Index>(block.free.size()),
                                    [&](Index i) { return force[block.free[to_size(i)]]; });
    return largest / block.length;
  });
}

template <class T>
T MemberModel<T>::largest_edge_change(const MemberVector<T>& displacement) const {
  T result = 0.0;
  run_member_loop<T>([&] {
    const Model& model = structure();
    T squared = 0.0;
    with_dimension(model, [&](auto dim) {
      squared = largest_of<T>(static_cast<Index>(model.edges.size()), [&](Index i) {
        const T change = along_edge<dim>(model.edges[to_size(i)], displacement).squaredNorm();
        return T(change * per_squared_length[i]);
      });
    });
    const T turn = largest_of<T>(static_cast<Index>(model.framed_edges.size()), [&](Index i) {
      return displacement[model.framed_edges[to_size(i)].theta];
    });
    result = sqrt(T::larger_magnitude(squared, turn * turn));
  });
  return result;
}

#define DER_INSTANTIATE(T) template struct MemberModel<T>;
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
