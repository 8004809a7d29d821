#include "der/model/dof_map.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace der::test {
namespace {

/// Three nodes in space and the angles of the two edges between them.
DofMap spatial_map() { return {3, 3, {0, 1}}; }

}  // namespace

TEST_CASE("a degree of freedom says what it is") {
  const DofMap map = spatial_map();
  CHECK(map.size() == 11);
  CHECK(map.position(2, 1) == 7);
  CHECK(map[7].kind == DofKind::Position);
  CHECK(map[7].owner == 2);
  CHECK(map[7].component == 1);
  CHECK(map.angle(1) == 10);
  CHECK(map[10].kind == DofKind::Angle);
  CHECK(map[10].owner == 1);
  CHECK(map.node_of(7) == 2);
  CHECK(map.node_of(10) == 1);
}

TEST_CASE("free degrees of freedom are eliminated node by node, angles after their edge's start") {
  DofMap map = spatial_map();
  CHECK(map.free() == std::vector<Index>{0, 1, 2, 9, 3, 4, 5, 10, 6, 7, 8});
  map.hold({0, 1, 2, 10});
  CHECK(map.free() == std::vector<Index>{9, 3, 4, 5, 6, 7, 8});
  CHECK(map.num_free() == 7);
  CHECK_FALSE(map.is_free(10));
  CHECK(map.free_index(1) == -1);
  for (Index i = 0; i < map.num_free(); ++i) CHECK(map.free_index(map.free()[to_size(i)]) == i);
}

TEST_CASE("the first node of a ring is eliminated after its last one, between two open rods") {
  // A node; a ring of three nodes and three edges; a node.
  DofMap map{2, 5, {1, 2, 3}};
  map.close({1, 2, 3});
  CHECK(map.free() == std::vector<Index>{0, 1, 10, 4, 5, 11, 6, 7, 12, 2, 3, 8, 9});
  map.hold({3, 6, 11});
  CHECK(map.free() == std::vector<Index>{0, 1, 10, 4, 5, 7, 12, 2, 8, 9});
  CHECK(map.free_index(2) == 7);
  CHECK(map.free_index(11) == -1);
}

TEST_CASE("norms count a radian as the model's length") {
  DofMap map = spatial_map();
  map.set_length(4.0);
  Vector values = Vector::Zero(11);
  values[3] = -3.0;  // m, or N
  values[9] = 1.0;   // rad, or N m
  CHECK(map.largest_motion(values) == 4.0);
  CHECK(map.largest_force(values) == 3.0);
  CHECK(map.most_moved(values) == 9);
  values[10] = -16.0;
  CHECK(map.largest_force(values) == 4.0);
  CHECK(map.force_of(10, values[10]) == 4.0);
  CHECK(map.force_of(3, values[3]) == 3.0);
  map.hold({10});
  CHECK(map.largest_force(values) == 4.0);
  CHECK(map.largest_free_force(values) == 3.0);
}

TEST_CASE("a norm of what is no number is no number, whichever block it is in") {
  const DofMap map = spatial_map();
  for (const Index dof : {0, 8, 9, 10}) {
    Vector values = Vector::Ones(11);
    values[dof] = std::numeric_limits<double>::quiet_NaN();
    CHECK(std::isnan(map.largest_motion(values)));
    CHECK(std::isnan(map.largest_force(values)));
    CHECK(std::isnan(map.largest_free_force(values)));
  }
}

}  // namespace der::test
