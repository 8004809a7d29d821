#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "der/core/index.hpp"
#include "der/core/types.hpp"
#include "der/energies/local_term.hpp"

namespace der {

/// The elements of one kind that no chain assembles.
template <class Kernel>
struct OffChainElements {
  static constexpr std::size_t kSlots = Kernel::kDofs * (Kernel::kDofs + 1) / 2;
  std::vector<std::size_t> elements;
  /// Where the entries of their matrices go: of each the lower triangle, column by column.
  std::vector<std::array<Index, kSlots>> slots;
};

/// Adds the derivatives of an element, in `double` or in lanes, to a gradient and, for the Hessian,
/// to the values of a matrix.
template <Derivatives D, int N, class T, class Slots, class Gradient, class Values>
void add_local(const LocalTerm<N, T>& local, const std::array<Index, to_size(N)>& dofs,
               const Slots& slots, Gradient&& gradient, Values&& values) {
  for (int i = 0; i < N; ++i) gradient[dofs[to_size(i)]] += local.gradient[i];
  if constexpr (D == Derivatives::Hessian) {
    const Index* slot = slots.data();
    for (int column = 0; column < N; ++column) {
      for (int row = column; row < N; ++row) values[*slot++] += local.hessian(row, column);
    }
  }
}

}  // namespace der
