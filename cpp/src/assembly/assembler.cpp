#include "der/assembly/assembler.hpp"

#include <algorithm>
#include <utility>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"

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

/// Which of the `size` elements of a kind no chain assembles.
template <class Kernel>
std::vector<std::size_t> loose_elements(std::size_t size, const std::vector<PlanarChain>& chains) {
  std::vector<bool> in_chain(size, false);
  for (const PlanarChain& chain : chains) {
    const auto [first, count] = chain.elements_of<Kernel>();
    std::fill_n(in_chain.begin() + static_cast<std::ptrdiff_t>(first), count, true);
  }
  std::vector<std::size_t> loose;
  for (std::size_t e = 0; e < size; ++e) {
    if (!in_chain[e]) loose.push_back(e);
  }
  return loose;
}

constexpr auto kKinds = std::make_index_sequence<std::tuple_size_v<ElementLists>>{};

}  // namespace

Assembler::Assembler(const Model& model, const MatrixLayout& layout)
    : model_(model),
      num_values_(layout.num_values() + 1),
      chains_(PlanarChain::find(model, layout)) {
  const auto slot_of = [&](Index a, Index b) {
    return layout.slot_or_spare(model.free_index[at(a)], model.free_index[at(b)]);
  };
  for (Index i = 0; i < model.num_free(); ++i) diagonal_slots_.push_back(layout.slot(i, i));
  for (const auto& [a, b, mass] : model.mass.coupling) {
    coupling_slots_.push_back({slot_of(a, a), slot_of(b, b), slot_of(a, b)});
  }
  for_each_pair(
      model.elements, scatter_,
      [&](const auto& list, auto& map) {
        using Kernel = typename std::decay_t<decltype(list)>::KernelType;
        map.elements = loose_elements<Kernel>(list.size(), chains_);
        for (const std::size_t e : map.elements) {
          map.slots.push_back(element_slots(list.dofs[e], slot_of));
        }
      },
      kKinds);
  for (const auto& dofs : std::get<ElementList<Stretch<2>>>(model.elements).dofs) {
    edge_slots_.push_back(element_slots(dofs, slot_of));
  }
}

template <Derivatives D>
void Assembler::assemble(const Vector& positions, const Vector& controls, Vector& gradient,
                         Vector* values) const {
  gradient.setZero();
  if constexpr (D == Derivatives::Hessian) values->setZero();
  for (const PlanarChain& chain : chains_) {
    if constexpr (D == Derivatives::Hessian) {
      chain.add_gradient_and_hessian(model_, positions, gradient, values->data());
    } else {
      chain.add_gradient(model_, positions, gradient);
    }
  }
  for_each_pair(
      model_.elements, scatter_,
      [&](const auto& list, const auto& map) {
        using Kernel = typename std::decay_t<decltype(list)>::KernelType;
        constexpr int n = Kernel::kDofs;
        LocalTerm<n> local;
        for (std::size_t k = 0; k < map.elements.size(); ++k) {
          const std::size_t e = map.elements[k];
          const auto& dofs = list.dofs[e];
          Kernel::template evaluate<D>(list.constants[e], controls, gather(dofs, positions), local);
          for (int i = 0; i < n; ++i) gradient[dofs[at(i)]] += local.gradient[i];
          if constexpr (D == Derivatives::Hessian) {
            const Index* slot = map.slots[k].data();
            double* entries = values->data();
            for (int column = 0; column < n; ++column) {
              for (int row = column; row < n; ++row) {
                entries[*slot++] += local.hessian(row, column);
              }
            }
          }
        }
      },
      kKinds);
}

void Assembler::gradient(const Vector& positions, const Vector& controls, Vector& gradient) const {
  assemble<Derivatives::Gradient>(positions, controls, gradient, nullptr);
}

void Assembler::gradient_and_hessian(const Vector& positions, const Vector& controls,
                                     Vector& gradient, Vector& values) const {
  assemble<Derivatives::Hessian>(positions, controls, gradient, &values);
}

void Assembler::add_mass(const Mass& mass, double factor, Vector& values) const {
  add_diagonal(mass.lumped, factor, values);
  for (std::size_t i = 0; i < mass.coupling.size(); ++i) {
    const double shared = factor * mass.coupling[i].mass;
    values[coupling_slots_[i].a] -= shared;
    values[coupling_slots_[i].b] -= shared;
    values[coupling_slots_[i].ab] += shared;
  }
}

void Assembler::add_tension_stiffness(const Vector& positions, const Vector& tension,
                                      Vector& values) const {
  const auto& edges = std::get<ElementList<Stretch<2>>>(model_.elements);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto ends = gather(edges.dofs[i], positions);
    const Vec2 e = ends.tail<2>() - ends.head<2>();
    const double length = e.norm();
    const Vec2 normal{-e.y() / length, e.x() / length};
    const Mat2 block = tension[static_cast<Index>(i)] / length * normal * normal.transpose();
    const Index* slot = edge_slots_[i].data();
    for (int column = 0; column < 4; ++column) {
      for (int row = column; row < 4; ++row) {
        const double entry = block(row % 2, column % 2);
        values[*slot++] += row / 2 == column / 2 ? entry : -entry;
      }
    }
  }
}

void Assembler::add_diagonal(const Vector& diagonal, double factor, Vector& values) const {
  for (std::size_t i = 0; i < diagonal_slots_.size(); ++i) {
    values[diagonal_slots_[i]] += factor * diagonal[model_.free_dofs[i]];
  }
}

void Assembler::shift_diagonal(double shift, Vector& values) const {
  for (const Index slot : diagonal_slots_) values[slot] += shift;
}

}  // namespace der
