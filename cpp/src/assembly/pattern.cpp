#include "der/assembly/pattern.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "der/core/index.hpp"

namespace der {
namespace {

/// (column, row) of every entry that an element of the model touches, with repetitions.
std::vector<std::pair<Index, Index>> touched_entries(const Model& model) {
  std::vector<std::pair<Index, Index>> entries;
  for (Index i = 0; i < model.num_free(); ++i) entries.emplace_back(i, i);
  for_each_list(model.elements, [&](const auto& list) {
    for (const auto& dofs : list.dofs) {
      for (const Index a : dofs) {
        for (const Index b : dofs) {
          const Index row = model.free_index[at(a)];
          const Index column = model.free_index[at(b)];
          if (column >= 0 && row > column) entries.emplace_back(column, row);
        }
      }
    }
  });
  return entries;
}

}  // namespace

Pattern build_pattern(const Model& model) {
  auto entries = touched_entries(model);
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());

  Pattern pattern;
  pattern.size = model.num_free();
  pattern.outer.assign(at(pattern.size) + 1, 0);
  for (const auto& [column, row] : entries) {
    ++pattern.outer[at(column) + 1];
    pattern.inner.push_back(row);
    pattern.half_bandwidth = std::max(pattern.half_bandwidth, row - column);
  }
  for (std::size_t j = 0; j < at(pattern.size); ++j) pattern.outer[j + 1] += pattern.outer[j];
  return pattern;
}

MatrixLayout MatrixLayout::compressed(const Pattern& pattern) {
  MatrixLayout layout;
  layout.pattern_ = &pattern;
  layout.num_values_ = pattern.nonzeros();
  return layout;
}

MatrixLayout MatrixLayout::band(Index size, Index half_bandwidth) {
  MatrixLayout layout;
  layout.width_ = half_bandwidth + 1;
  layout.num_values_ = size * layout.width_;
  return layout;
}

Index MatrixLayout::slot(Index row, Index column) const {
  assert(row >= column);
  if (pattern_ == nullptr) return column * width_ + (row - column);
  const auto begin = pattern_->inner.begin() + pattern_->outer[at(column)];
  const auto end = pattern_->inner.begin() + pattern_->outer[at(column) + 1];
  const auto found = std::lower_bound(begin, end, row);
  assert(found != end && *found == row);
  return static_cast<Index>(found - pattern_->inner.begin());
}

}  // namespace der
