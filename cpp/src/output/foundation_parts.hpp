#pragma once

#include <array>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// The part of an elastic foundation under one edge.
struct FoundationPart {
  Index edge = 0;
  double start = 0.0, end = 1.0;  ///< shares of the edge
  Vec2 stiffness;                 ///< [N/m^2]
  std::array<Index, 4> dofs;      ///< of the edge's ends
  Eigen::Vector4d drawn;          ///< where they have no force [m]

  /// Whether it starts or ends within its edge.
  [[nodiscard]] bool is_cut() const { return start > 0.0 || end < 1.0; }
  /// Its force beyond the edge's middle, less what the chain has of it at the edge's end [N].
  [[nodiscard]] Vec2 excess_beyond_middle(double edge_length, const State& state) const;
};

/// The parts under one rod, edge by edge.
std::vector<FoundationPart> foundation_parts(const RodLayout& rod, const Model& model);

/// Arc lengths [m] at which the stiffness of a rod's foundation jumps.
std::vector<double> foundation_jumps(const RodLayout& rod,
                                     const std::vector<FoundationPart>& parts);

}  // namespace der
