#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "output/spread_forces.hpp"

namespace der {

/// For each edge of a rod the true loads beyond its middle, less those that the chain has beyond
/// the edge: of point forces between nodes, and of the distributed forces and foundations that
/// begin or end within the edge.
class EdgeExcess {
 public:
  EdgeExcess(const RodMesh& rod, const SpreadForces& forces);

  /// Whether an edge has no such load.
  [[nodiscard]] bool none(Index edge) const;
  /// Their sum [N]; `forces` as in the constructor.
  [[nodiscard]] Vec3 force(Index edge, const SpreadForces& forces, const Model& model,
                           const State& state) const;

 private:
  struct Amount {
    std::size_t load = 0;
    double amount = 0.0;  // 1 of a point force, [m] of a distributed one
  };
  /// A foundation that begins or ends within the edge.
  struct CutFoundation {
    double start = 0.0, end = 1.0;  // shares of the edge
    Vec3 stiffness;                 // [N/m^2]
  };
  struct Loads {
    std::vector<Amount> forces;
    std::vector<Amount> distributed;
    std::vector<CutFoundation> foundations;
  };

  void add_forces(Index edge, const SpreadForces& forces);
  void add_distributed(std::size_t number);
  void add_foundation(const FoundationPlace& place);
  [[nodiscard]] Vec3 foundation_force(Index edge, const CutFoundation& foundation,
                                      const Model& model, const State& state) const;

  RodMesh rod_;
  std::vector<Loads> edges_;
};

}  // namespace der
