#include "der/assembly/assembler.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "der/assembly/planar_chain.hpp"
#include "der/assembly/spatial_chain.hpp"
#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/lane_values.hpp"
#include "der/energies/registry.hpp"
#include "der/energies/stiffness_across.hpp"
#include "der/energies/strain_rate.hpp"
#include "der/energies/viscous_term.hpp"
#include "der/model/dimension.hpp"
#include "energies/every_kind.hpp"

namespace der {
namespace {

/// Calls f(list, map) for each kind of element with its scatter map.
template <class Lists, class Maps, class F, std::size_t... I>
void for_each_pair(Lists&& lists, Maps&& maps, F&& f, std::index_sequence<I...> /*kinds*/) {
  (f(std::get<I>(lists), std::get<I>(maps)), ...);
}

/// Slots of the lower triangle of an element's matrix, column by column.
template <std::size_t N, class SlotOf>
std::array<Index, N*(N + 1) / 2> element_slots(const std::array<Index, N>& dofs,
                                               const SlotOf& slot_of) {
  std::array<Index, N*(N + 1) / 2> slots;
  std::size_t k = 0;
  for (std::size_t column = 0; column < N; ++column) {
    for (std::size_t row = column; row < N; ++row) slots[k++] = slot_of(dofs[row], dofs[column]);
  }
  return slots;
}

/// The elements, of the `size` of a kind, that no chain assembles.
template <class Kernel>
std::vector<std::size_t> loose_elements(std::size_t size, const std::vector<PlanarChain>& planar,
                                        const std::vector<SpatialChain>& spatial) {
  std::vector<bool> in_chain(size, false);
  const auto mark = [&](const auto& chains) {
    for (const auto& chain : chains) {
      const auto [first, count] = chain.template range_of<Kernel>();
      std::fill_n(in_chain.begin() + static_cast<std::ptrdiff_t>(first), count, true);
    }
  };
  mark(planar);
  mark(spatial);
  std::vector<std::size_t> loose;
  for (std::size_t e = 0; e < size; ++e) {
    if (!in_chain[e]) loose.push_back(e);
  }
  return loose;
}

template <class Lists>
struct OffChainOf;
template <class... Kernels>
struct OffChainOf<std::tuple<ElementList<Kernels>...>> {
  using type = std::tuple<OffChainElements<Kernels>...>;
};

/// The kinds of loose elements to go through.
enum class Kinds { All, OneByOne };
template <Kinds K, class Kernel>
constexpr bool kIsOf = K == Kinds::All || !GoesInLanes<Kernel>::value;

template <class Kernel>
bool is_one_by_one(const OffChainElements<Kernel>& loose) {
  return kIsOf<Kinds::OneByOne, Kernel> && !loose.elements.empty();
}

constexpr auto kKinds = std::make_index_sequence<std::tuple_size_v<ElementLists::Lists>>{};

}  // namespace

struct Assembler::ScatterMaps {
  /// Where a mass between two degrees of freedom goes.
  struct CouplingSlots {
    Index a;  // diagonal entries
    Index b;
    Index ab;  // the entry between them
  };

  std::vector<Index> diagonal;           // slot of each free degree of freedom
  std::vector<CouplingSlots> couplings;  // of each of the model's mass couplings
  std::vector<PlanarChain> planar_chains;
  std::vector<SpatialChain> spatial_chains;
  OffChainOf<ElementLists::Lists>::type elements;
  OffChainOf<ElementLists::Lists>::type damped;  // those with internal damping, in chains or not
  // Slots of every plain stretch element.
  EdgeSlots<2> planar_edges;
  EdgeSlots<3> spatial_edges;

  template <int Dim>
  [[nodiscard]] const auto& edges() const {
    if constexpr (Dim == 2) return planar_edges;
    if constexpr (Dim == 3) return spatial_edges;
  }

  template <Derivatives D>
  void assemble(const Model& model, const Configuration& here, Vector& gradient,
                Vector* values) const;
  template <Derivatives D, Kinds K>
  void add_loose(const LooseMember* members, int count) const;
};

Assembler::~Assembler() = default;

Assembler::Assembler(const Model& model, const MatrixLayout& layout)
    : model_(model), num_values_(layout.num_values() + 1) {
  const auto slot_of = [&](Index a, Index b) {
    return layout.slot_or_spare(model.dofs.free_index(a), model.dofs.free_index(b));
  };
  auto maps = std::make_shared<ScatterMaps>();
  for (Index i = 0; i < model.num_free(); ++i) maps->diagonal.push_back(layout.slot(i, i));
  for (const auto& [a, b, mass] : model.mass.coupling) {
    maps->couplings.push_back({slot_of(a, a), slot_of(b, b), slot_of(a, b)});
  }
  maps->planar_chains = PlanarChain::find(model, layout);
  maps->spatial_chains = SpatialChain::find(model, layout);
  for_each_pair(
      model.elements->lists, maps->elements,
      [&](const auto& list, auto& map) {
        using Kernel = typename std::decay_t<decltype(list)>::KernelType;
        map.elements =
            loose_elements<Kernel>(list.size(), maps->planar_chains, maps->spatial_chains);
        for (const std::size_t e : map.elements) {
          map.slots.push_back(element_slots(list.dofs[e], slot_of));
        }
      },
      kKinds);
  for_each_pair(
      model.elements->lists, maps->damped,
      [&](const auto& list, auto& map) {
        for (const DampedElement& damped : list.damped) {
          map.elements.push_back(damped.element);
          map.slots.push_back(element_slots(list.dofs[damped.element], slot_of));
        }
      },
      kKinds);
  for (const auto& dofs : elements_of<Stretch<2>>(*model.elements).dofs) {
    maps->planar_edges.push_back(element_slots(dofs, slot_of));
  }
  for (const auto& dofs : elements_of<Stretch<3>>(*model.elements).dofs) {
    maps->spatial_edges.push_back(element_slots(dofs, slot_of));
  }
  maps_ = std::move(maps);
}

Assembler::Assembler(const Model& model, const Assembler& like)
    : model_(model), num_values_(like.num_values_), maps_(like.maps_) {}

template <Derivatives D>
void Assembler::ScatterMaps::assemble(const Model& model, const Configuration& here,
                                      Vector& gradient, Vector* values) const {
  gradient.setZero();
  const auto add = [&](const auto& chains) {
    for (const auto& chain : chains) {
      if constexpr (D == Derivatives::Hessian) {
        chain.add_gradient_and_hessian(model, here, gradient, values->data());
      } else {
        chain.add_gradient(model, here, gradient);
      }
    }
  };
  add(planar_chains);
  add(spatial_chains);
  const LooseMember all{&model,
                        &here,
                        {here.coordinates.data()},
                        {gradient.data()},
                        {values != nullptr ? values->data() : nullptr}};
  add_loose<D, Kinds::All>(&all, 1);
  add_circulatory_forces(circulatory_loads(*model.elements), here, -1.0, gradient);
}

template <Derivatives D, Kinds K>
void Assembler::ScatterMaps::add_loose(const LooseMember* members, int count) const {
  for_each_pair(
      members->model->elements->lists, elements,
      [&](const auto& first, const auto& map) {
        using List = std::decay_t<decltype(first)>;
        using Kernel = typename List::KernelType;
        if constexpr (kIsOf<K, Kernel>) {
          if (map.elements.empty()) return;
          LocalTerm<Kernel::kDofs> local;
          for (const LooseMember* member = members; member != members + count; ++member) {
            const auto& list = std::get<List>(member->model->elements->lists);
            for (std::size_t k = 0; k < map.elements.size(); ++k) {
              const std::size_t e = map.elements[k];
              const auto& dofs = list.dofs[e];
              Kernel::template evaluate<D>(list.constants[e], *member->here,
                                           gather(dofs, member->coordinates), local);
              add_local<D>(local, dofs, map.slots[k], member->gradient, member->values);
            }
          }
        }
      },
      kKinds);
}

void Assembler::add_loose_gradient(const LooseMember* members, int count) const {
  maps_->add_loose<Derivatives::Gradient, Kinds::OneByOne>(members, count);
}

void Assembler::add_loose_hessian(const LooseMember* members, int count) const {
  maps_->add_loose<Derivatives::Hessian, Kinds::OneByOne>(members, count);
}

bool Assembler::has_loose() const {
  return std::apply([](const auto&... loose) { return (is_one_by_one(loose) || ...); },
                    maps_->elements);
}

template <class Kernel>
const OffChainElements<Kernel>& Assembler::loose() const {
  return std::get<OffChainElements<Kernel>>(maps_->elements);
}

namespace {

template <class Kernel>
struct Loose {
  static constexpr auto value = &Assembler::loose<Kernel>;
};

[[gnu::used]] constexpr auto kLoose = of_every_kind<Loose>();

}  // namespace

const std::vector<PlanarChain>& Assembler::planar_chains() const { return maps_->planar_chains; }

const std::vector<SpatialChain>& Assembler::spatial_chains() const { return maps_->spatial_chains; }

template <int Dim>
const Assembler::EdgeSlots<Dim>& Assembler::edge_slots() const {
  return maps_->edges<Dim>();
}
template const Assembler::EdgeSlots<2>& Assembler::edge_slots<2>() const;
template const Assembler::EdgeSlots<3>& Assembler::edge_slots<3>() const;

const std::vector<Index>& Assembler::diagonal_slots() const { return maps_->diagonal; }

void Assembler::gradient(const Configuration& here, Vector& gradient) const {
  maps_->assemble<Derivatives::Gradient>(model_, here, gradient, nullptr);
}

void Assembler::gradient_and_hessian(const Configuration& here, Vector& gradient,
                                     Vector& values) const {
  values.setZero();
  add_hessian(here, gradient, values);
}

void Assembler::add_hessian(const Configuration& here, Vector& gradient, Vector& values) const {
  maps_->assemble<Derivatives::Hessian>(model_, here, gradient, &values);
}

void Assembler::add_mass(const Mass& mass, double factor, Vector& values) const {
  add_diagonal(mass.lumped, factor, values);
  for (std::size_t i = 0; i < mass.coupling.size(); ++i) {
    const double shared = factor * mass.coupling[i].mass;
    const ScatterMaps::CouplingSlots& slots = maps_->couplings[i];
    values[slots.a] -= shared;
    values[slots.b] -= shared;
    values[slots.ab] += shared;
  }
}

Index Assembler::num_plain_edges() const {
  return static_cast<Index>(maps_->planar_edges.size() + maps_->spatial_edges.size());
}

template <int Dim>
void Assembler::add_tension_stiffness(const Configuration& here, const Vector& tension,
                                      Vector& values) const {
  const auto& edges = elements_of<Stretch<Dim>>(*model_.elements);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto e = Stretch<Dim>::edge(gather(edges.dofs[i], here.coordinates));
    const double length = e.norm();
    const auto block = stiffness_across(e, length, tension[static_cast<Index>(i)] / length);
    const Index* slot = maps_->edges<Dim>()[i].data();
    for (int column = 0; column < 2 * Dim; ++column) {
      for (int row = column; row < 2 * Dim; ++row) {
        const double entry = block(row % Dim, column % Dim);
        values[*slot++] += row / Dim == column / Dim ? entry : -entry;
      }
    }
  }
}

void Assembler::add_tension_stiffness(const Configuration& here, const Vector& tension,
                                      Vector& values) const {
  with_dimension(model_, [&](auto dim) { add_tension_stiffness<dim>(here, tension, values); });
}

void Assembler::add_internal_damping(const Configuration& here, double factor,
                                     Vector& values) const {
  for_each_pair(
      model_.elements->lists, maps_->damped,
      [&](const auto& list, const auto& map) {
        using Kernel = typename std::decay_t<decltype(list)>::KernelType;
        if constexpr (StrainRate<Kernel>::kExists) {
          for (std::size_t k = 0; k < list.damped.size(); ++k) {
            const auto matrix = viscous_matrix(list, list.damped[k], here);
            const Index* slot = map.slots[k].data();
            for (int column = 0; column < Kernel::kDofs; ++column) {
              for (int row = column; row < Kernel::kDofs; ++row) {
                values[*slot++] += factor * matrix(row, column);
              }
            }
          }
        }
      },
      kKinds);
}

double Assembler::largest_diagonal(const DofBlock& block, const Vector& values) const {
  double largest = 0.0;
  for (Index dof = block.first; dof < block.first + block.count; ++dof) {
    if (!model_.dofs.is_free(dof)) continue;
    const double entry = values[maps_->diagonal[to_size(model_.dofs.free_index(dof))]];
    largest = std::max(largest, std::abs(entry));
  }
  return largest;
}

void Assembler::add_diagonal(const Vector& diagonal, double factor, Vector& values) const {
  const std::vector<Index>& slots = maps_->diagonal;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    values[slots[i]] += factor * diagonal[model_.dofs.free()[i]];
  }
}

}  // namespace der
