#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <vector>

#include "der/core/types.hpp"
#include "der/energies/element_list.hpp"

namespace der {

/// Consecutive elements of a list.
struct ChainRange {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// Plain stretch elements, each of which begins where the one before ends, with the bend elements
/// between them: one fewer.
struct ChainRun {
  ChainRange edges;
  ChainRange bends;
  bool actuated = false;  ///< whether the rest shape of any of them is
};

/// Finds the runs in the lists of a model. `Stretch` has the coordinates of two nodes, `Bend` those
/// of three nodes, then perhaps the angles of its two edges. The coordinates of all nodes of a run
/// follow one another, and so do the angles.
template <class Stretch, class Bend>
class ChainRunFinder {
 public:
  ChainRunFinder(const ElementList<Stretch>& edges, const ElementList<Bend>& bends)
      : edges_(edges), bends_(bends) {
    for (std::size_t i = 0; i < bends.size(); ++i) starts_.emplace(bends.dofs[i][0], i);
  }

  /// All runs that are at least two edges long.
  [[nodiscard]] std::vector<ChainRun> find() const {
    std::vector<ChainRun> runs;
    for (std::size_t first = 0; first < edges_.size();) {
      const auto bend = starts_.find(edges_.dofs[first][0]);
      const std::size_t count = bend == starts_.end() ? 0 : length(first, bend->second);
      if (count >= 2) {
        const ChainRange edges{first, count};
        const ChainRange bends{bend->second, count - 1};
        runs.push_back({edges, bends, is_actuated(edges_, edges) || is_actuated(bends_, bends)});
      }
      first += std::max<std::size_t>(count, 1);
    }
    return runs;
  }

 private:
  static constexpr std::size_t kEdge = Stretch::kDofs;
  static constexpr std::size_t kNodes = 3 * kEdge / 2;  // coordinates of the nodes of a bend

  template <class Kernel>
  static bool is_actuated(const ElementList<Kernel>& list, const ChainRange& range) {
    const auto first = list.constants.begin() + static_cast<std::ptrdiff_t>(range.first);
    return std::any_of(first, first + static_cast<std::ptrdiff_t>(range.count),
                       [](const auto& constants) { return constants.is_actuated(); });
  }

  template <std::size_t N>
  static bool consecutive(const std::array<Index, N>& dofs, std::size_t first, std::size_t last) {
    for (std::size_t i = first + 1; i < last; ++i) {
      if (dofs[i] != dofs[i - 1] + 1) return false;
    }
    return true;
  }

  /// Whether bend element `bend` lies between edge `edge` and the one before it.
  [[nodiscard]] bool joins(std::size_t bend, std::size_t edge) const {
    if (bend >= bends_.size()) return false;
    const auto& dofs = bends_.dofs[bend];
    const auto& before = edges_.dofs[edge - 1];
    const auto& after = edges_.dofs[edge];
    return std::equal(before.begin(), before.end(), dofs.begin()) &&
           std::equal(after.begin(), after.end(), dofs.begin() + kEdge / 2) &&
           consecutive(dofs, kNodes, dofs.size());
  }

  /// Number of edges from `first` on that follow one another, with the bend elements from
  /// `first_bend` on between them.
  [[nodiscard]] std::size_t length(std::size_t first, std::size_t first_bend) const {
    const auto plain = [this](std::size_t edge) {
      return consecutive(edges_.dofs[edge], 0, kEdge);
    };
    std::size_t count = plain(first) ? 1 : 0;
    while (count > 0 && first + count < edges_.size() && plain(first + count) &&
           joins(first_bend + count - 1, first + count)) {
      ++count;
    }
    return count;
  }

  const ElementList<Stretch>& edges_;
  const ElementList<Bend>& bends_;
  std::map<Index, std::size_t> starts_;  // places of bends by their first degree of freedom
};

}  // namespace der
