#pragma once

#include <array>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der::statics {

/// Sums how far the edges with a moment turn, to see when a moment turns them without end: it winds
/// a rod up by M L/EI at most. Planar models only.
class PlanarMomentTurning {
 public:
  explicit PlanarMomentTurning(const Model& model);

  void reset() { turned_.setZero(); }
  /// Adds the step between two shapes. `controls` are the values of the model's tables.
  void add(const Vector& from, const Vector& to);
  /// Whether an edge has turned farther than the structure can resist.
  [[nodiscard]] bool is_unbounded(const Vector& controls) const;

 private:
  struct Moment {
    std::array<Index, 4> dofs;  // of the edge
    Index control = 0;
  };

  std::vector<Moment> moments_;
  double compliance_;  // largest turn of the structure by a unit moment [1/(N m)]
  Vector turned_;      // of each edge with a moment [rad]
};

}  // namespace der::statics
