#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "der/core/index.hpp"
#include "der/core/types.hpp"
#include "der/model/leg.hpp"
#include "der/model/model.hpp"
#include "output/rod_field.hpp"

namespace der {

/// A field with a sample at each node of each leg of a rod: two where legs meet.
class EachLegField : public RodField {
 public:
  [[nodiscard]] bool smooth_at(std::size_t i) const override { return smooth_[i]; }

 protected:
  explicit EachLegField(const RodMesh& rod) : RodField(arc_lengths(rod)) {
    for (std::size_t number = 0; number < rod.legs.size(); ++number) {
      const Leg& leg = rod.legs[number];
      for (Index node = 0; node <= leg.num_cells(); ++node) {
        places_.emplace_back(number, node);
        const Index first_or_last = node == 0 ? leg.first : node == leg.num_cells() ? leg.last : 0;
        smooth_.push_back(first_or_last == 0 || first_or_last == rod.num_edges());
      }
    }
  }
  /// The leg of each sample, and its node there.
  [[nodiscard]] const std::vector<std::pair<std::size_t, Index>>& places() const { return places_; }

 private:
  static std::vector<double> arc_lengths(const RodMesh& rod) {
    std::vector<double> places;
    for (const Leg& leg : rod.legs) {
      for (Index place = leg.first; place <= leg.last; ++place) {
        places.push_back(rod.arc_length_at(place));
      }
    }
    return places;
  }

  std::vector<std::pair<std::size_t, Index>> places_;
  std::vector<bool> smooth_;
};

/// The value at a node of a leg of what is known of each edge: linear through the middles of the
/// two nearest edges. Nodes and edges are counted from the start of the leg.
template <class T, class OfEdge>
T through_middles(const Leg& leg, const RodMesh& rod, Index node, const OfEdge& of_edge) {
  const Index last = leg.num_cells();
  if (last == 1) return of_edge(0);
  const auto length = [&](Index edge) { return rod.edge_length[to_size(leg.first + edge)]; };
  const Index before = std::min(std::max<Index>(node - 1, 0), last - 2);
  const double a = length(before);
  const double b = length(before + 1);
  const double from_middle = node <= before ? -0.5 * a : node == before + 1 ? 0.5 * a : 0.5 * a + b;
  const double share = from_middle / (0.5 * (a + b));
  return (1.0 - share) * of_edge(before) + share * of_edge(before + 1);
}

/// Continues values that are known at the inner nodes of a leg to its ends, along the line through
/// the two nearest.
template <class T>
void continue_to_ends(const Leg& leg, const RodMesh& rod, std::vector<T>& values) {
  const Index last = leg.num_cells();
  const auto length = [&](Index edge) { return rod.edge_length[to_size(leg.first + edge)]; };
  const auto beyond = [&](Index near, Index far, double share) -> T {
    return values[to_size(near)] + share * (values[to_size(near)] - values[to_size(far)]);
  };
  if (last == 2) values.front() = values.back() = values[1];
  if (last > 2) {
    values.front() = beyond(1, 2, length(0) / length(1));
    values.back() = beyond(last - 1, last - 2, length(last - 1) / length(last - 2));
  }
}

}  // namespace der
