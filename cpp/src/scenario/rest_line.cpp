#include "scenario/rest_line.hpp"

#include <cmath>

#include "der/core/nearest_node.hpp"

namespace der::scenario {

double distance(const Components& a, const Components& b) {
  const double in_plane = std::hypot(b[0] - a[0], b[1] - a[1]);
  return a.size() > 2 ? std::hypot(in_plane, b[2] - a[2]) : in_plane;
}

RestLine::RestLine(const std::vector<Components>& points, bool closed)
    : arc_length_(points.size()), closed_(closed) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    arc_length_[i] = arc_length_[i - 1] + distance(points[i - 1], points[i]);
  }
  length_ = arc_length_.back();
  if (closed) length_ += distance(points.back(), points.front());
}

double RestLine::arc_length(int node) const { return arc_length_[static_cast<std::size_t>(node)]; }

int RestLine::nearest_node(double s) const { return der::nearest_node(arc_length_, s); }

std::optional<int> RestLine::node_at(double s) const {
  if (closed_ && length_ - s <= same_place()) return 0;
  const int nearest = nearest_node(s);
  if (std::abs(arc_length(nearest) - s) > same_place()) return std::nullopt;
  return nearest;
}

}  // namespace der::scenario
