#include "scenario/rest_line.hpp"

#include <algorithm>
#include <cmath>

namespace der::scenario {

RestLine::RestLine(const std::vector<Components>& points) : arc_length_(points.size()) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    arc_length_[i] = arc_length_[i - 1] +
                     std::hypot(points[i][0] - points[i - 1][0], points[i][1] - points[i - 1][1]);
  }
}

double RestLine::arc_length(int node) const { return arc_length_[static_cast<std::size_t>(node)]; }

int RestLine::nearest_node(double s) const {
  const auto above = std::lower_bound(arc_length_.begin(), arc_length_.end(), s);
  const int after = std::min(static_cast<int>(above - arc_length_.begin()), num_nodes() - 1);
  if (after == 0) return 0;
  return s - arc_length(after - 1) < arc_length(after) - s ? after - 1 : after;
}

std::optional<int> RestLine::node_at(double s) const {
  const int nearest = nearest_node(s);
  if (std::abs(arc_length(nearest) - s) > same_place()) return std::nullopt;
  return nearest;
}

}  // namespace der::scenario
