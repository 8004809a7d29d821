#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "der/core/lanes.hpp"

namespace der {

/// The edges of a chain, shared out to the lanes of a number type: each has a part of the chain,
/// and all go along their parts at the same time.
template <class T>
struct LaneSpans {
  using Number = T;
  static constexpr int kLanes = LaneTraits<T>::kCount;
  std::array<std::ptrdiff_t, kLanes> first;  ///< the first edge of each lane
  std::ptrdiff_t count;                      ///< edges of the first lanes; others have one fewer
  int longer;                                ///< number of these first lanes, at least one

  /// `edges` are at least as many as there are lanes.
  static LaneSpans of(std::ptrdiff_t edges) {
    LaneSpans spans;
    spans.count = (edges + kLanes - 1) / kLanes;
    spans.longer = static_cast<int>(edges - kLanes * (spans.count - 1));
    for (std::ptrdiff_t lane = 0; lane < kLanes; ++lane) {
      spans.first[static_cast<std::size_t>(lane)] =
          lane * (spans.count - 1) + std::min<std::ptrdiff_t>(lane, spans.longer);
    }
    return spans;
  }

  [[nodiscard]] std::ptrdiff_t edge(int lane, std::ptrdiff_t j) const {
    return first[static_cast<std::size_t>(lane)] + j;
  }
  /// Number of lanes that have an edge `j` places after their first.
  [[nodiscard]] int lanes_with(std::ptrdiff_t j) const { return j + 1 < count ? kLanes : longer; }
  /// Whether the edge `j` places after the first may be the last of a lane.
  [[nodiscard]] bool is_near_end(std::ptrdiff_t j) const { return j + 2 >= count; }
};

/// Calls `work` for the first `lanes` lanes of a number type; most often these are all.
template <class T, class Work>
void for_each_lane(int lanes, const Work& work) {
  if (lanes == LaneTraits<T>::kCount) {
    for (int lane = 0; lane < LaneTraits<T>::kCount; ++lane) work(lane);
  } else {
    for (int lane = 0; lane < lanes; ++lane) work(lane);
  }
}

/// Calls `add` with the spans in which to go along a chain: in four lanes, unless it is so short
/// that the edges beside the parts, which are looked at twice, cost more than lanes gain.
template <class Add>
void in_spans(std::size_t edges, const Add& add) {
  constexpr std::ptrdiff_t kWorthLanes = 8;
  const auto count = static_cast<std::ptrdiff_t>(edges);
  if (count >= kWorthLanes) {
    add(LaneSpans<FourLanes>::of(count));
  } else {
    add(LaneSpans<double>::of(count));
  }
}

}  // namespace der
