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

/// The free degrees of freedom of a ring, which follow one another. None: it is held as a whole, or
/// has some that are among those of other rods.
Border whole_ring(const RodMesh& rod, const Model& model) {
  Border ring{model.num_free(), 0, 0};
  Index count = 0;
  const auto enter = [&](Index dof) {
    const Index place = model.dofs.free_index(dof);
    if (place < 0) return;
    ++count;
    ring.first_column = std::min(ring.first_column, place);
    ring.end = std::max(ring.end, place + 1);
  };
  for (const Index node : rod.nodes) {
    for (int c = 0; c < model.dimension; ++c) enter(model.dof(node, c));
  }
  for (Index edge = 0; model.has_sections() && edge < rod.num_edges(); ++edge) {
    enter(model.dofs.angle(rod.first_edge + edge));
  }
  for (const Leg& leg : rod.legs) {
    if (leg.start.rotation >= 0) enter(model.dofs.rotation(leg.start.rotation));
  }
  if (ring.end - ring.first_column != count) return {};
  return ring;
}

/// The borders that keep the band of rings narrow: the rows of a ring from the first one on that
/// reaches back over half of it.
std::vector<Border> find_borders(const Entries& entries, const Model& model) {
  std::vector<Border> borders;
  for (const RodMesh& rod : model.rods) {
    if (!rod.closed) continue;
    Border border = whole_ring(rod, model);
    border.first_row = border.end;
    for (const auto& [column, row] : entries) {
      const bool is_here = column >= border.first_column && row < border.end;
      const bool reaches_far = 2 * (row - column) >= border.end - border.first_column;
      if (is_here && reaches_far && row > column)
        border.first_row = std::min(border.first_row, row);
    }
    if (border.first_row < border.end) borders.push_back(border);
  }
  return borders;
}

/// The border that has an entry; null: none does.
const Border* border_of(const std::vector<Border>& borders, Index row, Index column) {
  const auto after = std::upper_bound(borders.begin(), borders.end(), row,
                                      [](Index i, const Border& b) { return i < b.first_row; });
  if (after == borders.begin()) return nullptr;
  const Border& border = *(after - 1);
  const bool is_inside = row < border.end && column < border.first_row;
  return is_inside && column >= border.first_column ? &border : nullptr;
}

Pattern compress(Entries entries, const Model& model) {
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());

  Pattern pattern;
  pattern.size = model.num_free();
  pattern.borders = find_borders(entries, model);
  for (const Border& border : pattern.borders) {
    pattern.half_bandwidth = std::max(pattern.half_bandwidth, border.rows() - 1);
  }
  pattern.outer.assign(to_size(pattern.size) + 1, 0);
  for (const auto& [column, row] : entries) {
    ++pattern.outer[to_size(column) + 1];
    pattern.inner.push_back(row);
    if (border_of(pattern.borders, row, column) != nullptr) continue;
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

MatrixLayout MatrixLayout::bordered_band(const Pattern& pattern) {
  MatrixLayout layout = band(pattern.size, pattern.half_bandwidth);
  layout.borders_ = pattern.borders;
  for (const Border& border : layout.borders_) {
    layout.num_values_ += border.columns() * border_stride(border);
  }
  return layout;
}

Index MatrixLayout::slot_or_spare(Index i, Index j) const {
  return i < 0 || j < 0 ? num_values_ : slot(std::max(i, j), std::min(i, j));
}

Index MatrixLayout::slot(Index row, Index column) const {
  assert(row >= column);
  if (pattern_ == nullptr) {
    const Index below = row - column;
    if (half_ >= 0) {
      const Index behind_middle = half_ + width_ - 1;
      if (row < behind_middle) return 2 * (column * width_ + below);
      const Index padding = half_ + behind_middle - size_;
      return 2 * ((size_ - 1 - row + padding) * width_ + below) + 1;
    }
    const Border* own = border_of(borders_, row, column);
    if (own == nullptr) return column * width_ + below;
    Index first = size_ * width_;
    for (const Border* before = borders_.data(); before != own; ++before) {
      first += before->columns() * border_stride(*before);
    }
    return first + (column - own->first_column) * border_stride(*own) + (row - own->first_row);
  }
  const auto begin = pattern_->inner.begin() + pattern_->outer[to_size(column)];
  const auto end = pattern_->inner.begin() + pattern_->outer[to_size(column) + 1];
  const auto found = std::lower_bound(begin, end, row);
  assert(found != end && *found == row);
  return static_cast<Index>(found - pattern_->inner.begin());
}

}  // namespace der
