#include "scenario/rest_line.hpp"

#include <cmath>
#include <utility>

#include "der/core/nearest_node.hpp"
#include "der/scenario/rod.hpp"

namespace der::scenario {

double distance(const Components& a, const Components& b) {
  const double in_plane = std::hypot(b[0] - a[0], b[1] - a[1]);
  return a.size() > 2 ? std::hypot(in_plane, b[2] - a[2]) : in_plane;
}

RestLine::RestLine(const std::vector<Components>& points, bool closed,
                   std::optional<double> rest_length)
    : arc_length_(points.size()), closed_(closed) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    arc_length_[i] = arc_length_[i - 1] + distance(points[i - 1], points[i]);
  }
  length_ = arc_length_.back();
  if (closed) length_ += distance(points.back(), points.front());
  set_rest_length(rest_length);
}

RestLine::RestLine(std::vector<double> arc_length, double length, bool closed,
                   std::optional<double> rest_length)
    : arc_length_(std::move(arc_length)), length_(length), closed_(closed) {
  set_rest_length(rest_length);
}

void RestLine::set_rest_length(std::optional<double> rest_length) {
  if (!rest_length) return;
  for (double& s : arc_length_) s *= *rest_length / length_;
  length_ = *rest_length;
}

double RestLine::arc_length(int node) const { return arc_length_[static_cast<std::size_t>(node)]; }

int RestLine::nearest_node(double s) const { return der::nearest_node(arc_length_, s); }

std::optional<int> RestLine::node_at(double s) const {
  if (closed_ && length_ - s <= same_place()) return 0;
  const int nearest = nearest_node(s);
  if (std::abs(arc_length(nearest) - s) > same_place()) return std::nullopt;
  return nearest;
}

std::optional<int> RestLine::cell_at(double s) const {
  const int last = num_nodes() - 1;
  const auto place = [&](int node) { return node > last ? length_ : arc_length(node); };
  int before = nearest_node(s);
  if (before > 0 && s < place(before)) --before;
  if (before == last && !closed_) return last;
  const double middle = 0.5 * (place(before) + place(before + 1));
  if (std::abs(s - middle) <= same_place()) return std::nullopt;
  return s < middle ? before : (before + 1) % num_nodes();
}

double RestLine::arc_length_of(const Location& at) const {
  switch (at.kind) {
    case Location::Kind::Middle:
      return 0.5 * length_;
    case Location::Kind::End:
      return length_;
    case Location::Kind::ArcLength:
      return at.arc_length;
    case Location::Kind::Node:
      return arc_length(at.node < 0 ? at.node + num_nodes() : at.node);
    case Location::Kind::Start:
    case Location::Kind::All:
      break;
  }
  return 0.0;
}

double rest_scale(const Rod& rod) {
  return rod.rest_length ? *rod.rest_length / RestLine(rod.points, rod.closed).length() : 1.0;
}

}  // namespace der::scenario
