#include "der/assembly/pattern.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "der/core/index.hpp"
#include "der/energies/registry.hpp"

namespace der {
namespace {

/// (column, row) of entries of the lower triangle, repetitions allowed.
using Entries = std::vector<std::pair<Index, Index>>;

void add_entry(Index dof_a, Index dof_b, const Model& model, Entries& entries) {
  const Index a = model.dofs.free_index(dof_a);
  const Index b = model.dofs.free_index(dof_b);
  if (a >= 0 && b >= 0) entries.emplace_back(std::min(a, b), std::max(a, b));
}

void add_mass_entries(const Model& model, Entries& entries) {
  for (const Index dof : model.dofs.free()) add_entry(dof, dof, model, entries);
  for (const auto& [a, b, mass] : model.mass.coupling) add_entry(a, b, model, entries);
}

Pattern compress(Entries entries, const Model& model) {
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());

  Pattern pattern;
  pattern.size = model.num_free();
  pattern.outer.assign(to_size(pattern.size) + 1, 0);
  for (const auto& [column, row] : entries) {
    ++pattern.outer[to_size(column) + 1];
    pattern.inner.push_back(row);
    pattern.half_bandwidth = std::max(pattern.half_bandwidth, row - column);
  }
  for (std::size_t j = 0; j < to_size(pattern.size); ++j) pattern.outer[j + 1] += pattern.outer[j];
  return pattern;
}

}  // namespace

Pattern build_pattern(const Model& model) {
  Entries entries;
  add_mass_entries(model, entries);
  for_each_list(*model.elements, [&](const auto& list) {
    for (const auto& dofs : list.dofs) {
      for (std::size_t i = 0; i < dofs.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) add_entry(dofs[i], dofs[j], model, entries);
      }
    }
  });
  return compress(std::move(entries), model);
}

Pattern build_mass_pattern(const Model& model) {
  Entries entries;
  add_mass_entries(model, entries);
  return compress(std::move(entries), model);
}

MatrixLayout MatrixLayout::compressed(const Pattern& pattern) {
  MatrixLayout layout;
  layout.pattern_ = &pattern;
  layout.size_ = pattern.size;
  layout.num_values_ = pattern.nonzeros();
  return layout;
}

MatrixLayout MatrixLayout::band(Index size, Index half_bandwidth) {
  MatrixLayout layout;
  layout.size_ = size;
  layout.width_ = half_bandwidth + 1;
  layout.num_values_ = size * layout.width_;
  return layout;
}

MatrixLayout MatrixLayout::two_ended(Index size, Index half_bandwidth) {
  MatrixLayout layout = band(size, half_bandwidth);
  layout.half_ = (size - half_bandwidth + 1) / 2;
  layout.num_values_ = 2 * (layout.half_ + half_bandwidth) * layout.width_;
  return layout;
}

Index MatrixLayout::slot_or_spare(Index i, Index j) const {
  return i < 0 || j < 0 ? num_values_ : slot(std::max(i, j), std::min(i, j));
}

void MatrixLayout::shift_diagonal(double shift, Vector& values) const {
  for (Index i = 0; i < size_; ++i) values[slot(i, i)] += shift;
}

Index MatrixLayout::slot(Index row, Index column) const {
  assert(row >= column);
  if (pattern_ == nullptr) {
    const Index below = row - column;
    if (half_ < 0) return column * width_ + below;
    const Index behind_middle = half_ + width_ - 1;
    if (row < behind_middle) return 2 * (column * width_ + below);
    const Index padding = half_ + behind_middle - size_;
    return 2 * ((size_ - 1 - row + padding) * width_ + below) + 1;
  }
  const auto begin = pattern_->inner.begin() + pattern_->outer[to_size(column)];
  const auto end = pattern_->inner.begin() + pattern_->outer[to_size(column) + 1];
  const auto found = std::lower_bound(begin, end, row);
  assert(found != end && *found == row);
  return static_cast<Index>(found - pattern_->inner.begin());
}

}  // namespace der
