#include "der/lanes/member_assembler.hpp"

#include "der/core/largest_of.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/stiffness_across.hpp"
#include "der/energies/stretch.hpp"
#include "der/model/dimension.hpp"

namespace der {
namespace {

/// The numbers of one lane.
template <class T>
Strided<double> lane_of(MemberVector<T>& numbers, int lane) {
  return {reinterpret_cast<double*>(numbers.data()) + lane, LaneTraits<T>::kCount};
}
template <class T>
Strided<const double> lane_of(const MemberVector<T>& numbers, int lane) {
  return {reinterpret_cast<const double*>(numbers.data()) + lane, LaneTraits<T>::kCount};
}

template <class T>
std::array<Assembler::LooseMember, to_size(LaneTraits<T>::kCount)> loose_members(
    const MemberModel<T>& model, const MemberConfigurations<T>& here,
    const MemberVector<T>& coordinates, MemberVector<T>& gradient, MemberVector<T>* values) {
  std::array<Assembler::LooseMember, to_size(LaneTraits<T>::kCount)> members;
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    members[to_size(lane)] = {model.models[to_size(lane)], &here[to_size(lane)],
                              lane_of(coordinates, lane), lane_of(gradient, lane),
                              values != nullptr ? lane_of(*values, lane) : Strided<double>{}};
  }
  return members;
}

template <class T>
void set_zero(MemberVector<T>& numbers) {
  std::fill_n(numbers.data(), numbers.size(), T(0.0));
}

}  // namespace

template <class T>
MemberAssembler<T>::MemberAssembler(const MemberModel<T>& model,
                                    const MemberAssemblers<T>& assemblers,
                                    const MemberControls<T>& controls)
    : model_(model),
      assembler_(*assemblers[0]),
      has_loose_(assembler_.has_loose()),
      controls_(controls),
      loose_(loose_kinds<T>(assembler_, model.models)) {
  for (const PlanarChain& chain : assembler_.planar_chains()) {
    planar_chains_.push_back(chain.constants_of<T>(model.models));
  }
  for (const SpatialChain& chain : assembler_.spatial_chains()) {
    spatial_chains_.push_back(chain.constants_of<T>(model.models));
  }
  set_masses(assemblers);
  with_dimension(model.structure(), [&](auto dim) { set_edges<dim>(); });
}

template <class T>
template <int Dim>
void MemberAssembler<T>::set_edges() {
  const auto edges = [&](int lane) -> const auto& {
    return elements_of<Stretch<Dim>>(*model_.models[to_size(lane)]->elements).constants;
  };
  const auto count = static_cast<Index>(edges(0).size());
  EA_.resize(count);
  rest_length_.resize(count);
  for (Index i = 0; i < count; ++i) {
    EA_[i] = in_lanes<T>([&](int lane) { return edges(lane)[to_size(i)].EA; });
    rest_length_[i] = in_lanes<T>([&](int lane) { return edges(lane)[to_size(i)].rest_length; });
  }
}

template <class T>
void MemberAssembler<T>::set_masses(const MemberAssemblers<T>& assemblers) {
  MemberVector<T> all(num_values());
  Vector values(num_values());
  for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) {
    values.setZero();
    assemblers[to_size(lane)]->add_mass(model_.models[to_size(lane)]->mass, 1.0, values);
    all.set_lane(lane, values);
  }
  for (Index slot = 0; slot < num_values(); ++slot) {
    if (!in_all_lanes<T>([&](int lane) { return all[slot].lane(lane) == 0.0; })) {
      mass_slots_.push_back(slot);
    }
  }
  masses_.resize(static_cast<Index>(mass_slots_.size()));
  for (Index i = 0; i < masses_.size(); ++i) masses_[i] = all[mass_slots_[to_size(i)]];
}

template <class T>
void MemberAssembler<T>::follow_frames() {
  for (const auto& kind : loose_) kind->follow(controls_.here());
}

template <class T>
template <Derivatives D>
void MemberAssembler<T>::add_chains(const MemberVector<T>& coordinates,
                                    const MemberVector<T>& frames, T* gradient, T* values) const {
  const std::vector<PlanarChain>& planar = assembler_.planar_chains();
  for (std::size_t i = 0; i < planar.size(); ++i) {
    planar[i].add_members<D, T>(planar_chains_[i], coordinates.data(), gradient, values);
  }
  const std::vector<SpatialChain>& spatial = assembler_.spatial_chains();
  for (std::size_t i = 0; i < spatial.size(); ++i) {
    spatial[i].add_members<D, T>(spatial_chains_[i], coordinates.data(), frames.data(), gradient,
                                 values);
  }
}

template <class T>
void MemberAssembler<T>::gradient(const MemberVector<T>& coordinates, const MemberVector<T>& frames,
                                  MemberVector<T>& gradient) const {
  run_member_loop<T>([&] { set_zero(gradient); });
  add_chains<Derivatives::Gradient>(coordinates, frames, gradient.data(), nullptr);
  for (const auto& kind : loose_) kind->add_gradient(coordinates, gradient);
  if (!has_loose_) return;
  const auto members = loose_members<T>(model_, controls_.here(), coordinates, gradient, nullptr);
  assembler_.add_loose_gradient(members.data(), LaneTraits<T>::kCount);
}

template <class T>
void MemberAssembler<T>::system(const T& inertia, const MemberVector<T>& coordinates,
                                const MemberVector<T>& frames, MemberVector<T>& gradient,
                                MemberVector<T>& values) const {
  run_member_loop<T>([&] {
    set_zero(gradient);
    set_zero(values);
    for (Index i = 0; i < masses_.size(); ++i) {
      values[mass_slots_[to_size(i)]] = inertia * masses_[i];
    }
  });
  add_chains<Derivatives::Hessian>(coordinates, frames, gradient.data(), values.data());
  for (const auto& kind : loose_) kind->add_hessian(coordinates, gradient, values);
  if (!has_loose_) return;
  const auto members = loose_members<T>(model_, controls_.here(), coordinates, gradient, &values);
  assembler_.add_loose_hessian(members.data(), LaneTraits<T>::kCount);
}

template <class T>
void MemberAssembler<T>::use_predicted_tension(const MemberVector<T>& coordinates,
                                               const MemberVector<T>& step,
                                               MemberVector<T>& values) const {
  with_dimension(model_.structure(),
                 [&](auto dim) { use_predicted_tension_in<dim>(coordinates, step, values); });
}

template <class T>
template <int Dim>
void MemberAssembler<T>::use_predicted_tension_in(const MemberVector<T>& coordinates,
                                                  const MemberVector<T>& step,
                                                  MemberVector<T>& values) const {
  using std::sqrt;
  using Vec = Eigen::Matrix<T, Dim, 1>;
  const auto& dofs = elements_of<Stretch<Dim>>(*model_.structure().elements).dofs;
  const auto& slots = assembler_.template edge_slots<Dim>();
  run_member_loop<T>([&] {
    for (Index i = 0; i < EA_.size(); ++i) {
      const auto& place = dofs[to_size(i)];
      const auto edge = [&](const MemberVector<T>& field) {
        Vec vector;
        for (int c = 0; c < Dim; ++c) {
          vector[c] = field[place[to_size(Dim + c)]] - field[place[to_size(c)]];
        }
        return vector;
      };
      const Vec e = edge(coordinates);
      const Vec change = edge(step);
      const T excess = excess_tension<T, Dim>(e - change, change, e, EA_[i], rest_length_[i]);
      const T length = sqrt(T(e.squaredNorm()));
      const Eigen::Matrix<T, Dim, Dim> block = stiffness_across(e, length, T(excess / length));
      const Index* slot = slots[to_size(i)].data();
      for (int column = 0; column < 2 * Dim; ++column) {
        for (int row = column; row < 2 * Dim; ++row) {
          const T& entry = block(row % Dim, column % Dim);
          if (row / Dim == column / Dim) {
            values[*slot++] += entry;
          } else {
            values[*slot++] -= entry;
          }
        }
      }
    }
  });
}

template <class T>
T MemberAssembler<T>::largest_elastic_force(const MemberVector<T>& coordinates,
                                            const MemberVector<T>& values) const {
  const std::vector<Index>& slots = assembler_.diagonal_slots();
  const DofMap& dofs = model_.structure().dofs;
  T sum = 0.0;
  run_member_loop<T>([&] {
    for (const auto& block : model_.blocks) {
      const T stiffness = largest_of<T>(static_cast<Index>(block.free.size()), [&](Index i) {
        return values[slots[to_size(dofs.free_index(block.free[to_size(i)]))]];
      });
      const T coordinate =
          largest_of<T>(block.count, [&](Index i) { return coordinates[block.first + i]; });
      sum += stiffness * coordinate / block.length;
    }
  });
  return sum;
}

template <class T>
void MemberAssembler<T>::add_damping(const T& factor, MemberVector<T>& values) const {
  const std::vector<Index>& slots = assembler_.diagonal_slots();
  const std::vector<Index>& free = model_.structure().dofs.free();
  run_member_loop<T>([&] {
    for (std::size_t i = 0; i < slots.size(); ++i) {
      values[slots[i]] += factor * model_.damping[free[i]];
    }
  });
}

#define DER_INSTANTIATE(T) template class MemberAssembler<T>;
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
