#include "der/assembly/assembler.hpp"

#include <algorithm>
#include <utility>

#include "der/assembly/element_energy.hpp"
#include "der/core/index.hpp"

namespace der {
namespace {

/// Calls f(list, map) for each kind of element with its scatter map.
template <class Lists, class Maps, class F, std::size_t... I>
void for_each_pair(Lists&& lists, Maps&& maps, F&& f, std::index_sequence<I...> /*kinds*/) {
  (f(std::get<I>(lists), std::get<I>(maps)), ...);
}

constexpr auto kKinds = std::make_index_sequence<std::tuple_size_v<ElementLists>>{};

}  // namespace

Assembler::Assembler(const Model& model, const MatrixLayout& layout)
    : model_(model), num_values_(layout.num_values() + 1) {
  const Index spare = layout.num_values();
  const auto slot_of = [&](Index a, Index b) {
    const Index i = model.free_index[at(a)];
    const Index j = model.free_index[at(b)];
    return i < 0 || j < 0 ? spare : layout.slot(std::max(i, j), std::min(i, j));
  };
  for (Index i = 0; i < model.num_free(); ++i) diagonal_slots_.push_back(layout.slot(i, i));
  for (const auto& [a, b, mass] : model.mass.coupling) {
    coupling_slots_.push_back({slot_of(a, a), slot_of(b, b), slot_of(a, b)});
  }
  for_each_pair(
      model.elements, scatter_,
      [&](const auto& list, auto& map) {
        for (const auto& dofs : list.dofs) {
          auto& slots = map.slots.emplace_back();
          std::size_t k = 0;
          for (std::size_t column = 0; column < dofs.size(); ++column) {
            for (std::size_t row = column; row < dofs.size(); ++row) {
              slots[k++] = slot_of(dofs[row], dofs[column]);
            }
          }
        }
      },
      kKinds);
}

template <Derivatives D>
void Assembler::assemble(const Vector& positions, const Vector& controls, Vector& gradient,
                         Vector* values) const {
  gradient.setZero();
  if constexpr (D == Derivatives::Hessian) values->setZero();
  for_each_pair(
      model_.elements, scatter_,
      [&](const auto& list, const auto& map) {
        using Kernel = typename std::decay_t<decltype(list)>::KernelType;
        constexpr int n = Kernel::kDofs;
        LocalTerm<n> local;
        for (std::size_t e = 0; e < list.size(); ++e) {
          const auto& dofs = list.dofs[e];
          Kernel::template evaluate<D>(list.constants[e], controls, gather(dofs, positions), local);
          for (int i = 0; i < n; ++i) gradient[dofs[at(i)]] += local.gradient[i];
          if constexpr (D == Derivatives::Hessian) {
            const Index* slot = map.slots[e].data();
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
  const auto& map = std::get<ScatterMap<ElementList<Stretch<2>>>>(scatter_);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto ends = gather(edges.dofs[i], positions);
    const Vec2 e = ends.tail<2>() - ends.head<2>();
    const double length = e.norm();
    const Vec2 normal{-e.y() / length, e.x() / length};
    const Mat2 block = tension[static_cast<Index>(i)] / length * normal * normal.transpose();
    const Index* slot = map.slots[i].data();
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
