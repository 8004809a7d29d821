#pragma once

#include <optional>
#include <vector>

#include "der/scenario/location.hpp"
#include "der/scenario/series.hpp"

namespace der::scenario {

/// Distance of two points that have as many components [m].
double distance(const Components& a, const Components& b);

/// A rod's rest length as a line with nodes on it.
class RestLine {
 public:
  /// `points` [m], at least two; of a `closed` rod the last is joined to the first.
  /// `rest_length` [m] replaces the length as drawn.
  explicit RestLine(const std::vector<Components>& points, bool closed = false,
                    std::optional<double> rest_length = std::nullopt);

  /// A curve of this `length` [m] with nodes at these arc lengths [m].
  RestLine(std::vector<double> arc_length, double length, bool closed,
           std::optional<double> rest_length);

  [[nodiscard]] int num_nodes() const { return static_cast<int>(arc_length_.size()); }
  [[nodiscard]] bool closed() const { return closed_; }
  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] double arc_length(int node) const;
  /// As der::nearest_node.
  [[nodiscard]] int nearest_node(double s) const;
  /// The node at arc length `s` [m], if there is one within `same_place()`.
  [[nodiscard]] std::optional<int> node_at(double s) const;
  /// The node in whose Voronoi cell arc length `s` [m] lies; none in the middle of an edge, where
  /// two cells meet.
  [[nodiscard]] std::optional<int> cell_at(double s) const;
  /// Arc length [m] of a checked location, which is a single place.
  [[nodiscard]] double arc_length_of(const Location& at) const;
  /// Two arc lengths [m] closer than this are the same place.
  [[nodiscard]] double same_place() const { return 1e-9 * length(); }

 private:
  std::vector<double> arc_length_;  // of each node [m]
  double length_ = 0.0;             // [m]
  bool closed_;

  void set_rest_length(std::optional<double> rest_length);
};

}  // namespace der::scenario
