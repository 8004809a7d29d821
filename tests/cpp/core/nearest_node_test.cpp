#include "der/core/nearest_node.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace der;

TEST_CASE("the nearest node, the later of two, within the rod and beyond its ends") {
  const std::vector<double> arc_length{0.0, 0.5, 0.75, 2.0};
  const std::vector<std::pair<double, Index>> expected{{-1.0, 0}, {0.0, 0}, {0.2, 0}, {0.25, 1},
                                                       {0.5, 1},  {0.6, 1}, {0.7, 2}, {1.3, 2},
                                                       {1.4, 3},  {2.0, 3}, {9.0, 3}};
  for (const auto& place : expected) {
    const double s = place.first;
    CAPTURE(s);
    CHECK(nearest_node(arc_length, s) == place.second);
  }
  CHECK(nearest_node({0.0}, 3.0) == 0);
}
