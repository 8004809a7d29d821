#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/location.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// The point forces between the nodes of a rod, of loads and of springs: where they stand, what
/// they are, and the nodes over which the chain spreads them. In a plane all z components are 0.
/// Those of a ring are there three times, one length of the ring apart (`turns_of`): one of them is
/// where its edges see it.
class SpreadForces {
 public:
  struct Force {
    ForcePlace place;
    std::vector<Weighted> nodes;
  };

  SpreadForces(const RodMesh& rod, const Model& model);

  [[nodiscard]] std::size_t size() const { return forces_.size(); }
  [[nodiscard]] const Force& operator[](std::size_t i) const { return forces_[i]; }

  /// [m]
  [[nodiscard]] Vec3 node_point(Index node, const State& state) const;
  /// Where force number `i` stands [m].
  [[nodiscard]] Vec3 point(std::size_t i, const State& state) const;
  /// Force number `i` [N].
  [[nodiscard]] Vec3 value(std::size_t i, const Model& model, const State& state) const;

 private:
  int dimension_;
  RodMesh rod_;
  std::vector<Index> first_dofs_;  // of each node
  std::vector<Force> forces_;
};

}  // namespace der
