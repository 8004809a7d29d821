#pragma once

#include <array>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/scenario/series.hpp"

namespace der {

/// A force that keeps its direction and may follow a table over time, or a program. Its tables are
/// entered into the model once, however many nodes share it.
class DeadForce {
 public:
  /// `is_set`: whether a program may set it, so that even a constant one is a table.
  DeadForce(const scenario::VectorSeries& force, bool is_set, Model& model);
  /// Adds `weight` times the force to a node.
  void act_on(Index node, double weight, Model& model) const;
  /// The controls that hold its components [N], for what reads it off the model: of a constant
  /// force the tables of one value that a path of loads scales with it. -1: there is no such
  /// component.
  [[nodiscard]] std::array<Index, 3> as_controls(Model& model) const;

 private:
  scenario::Components constant_;  // empty: it follows tables
  std::vector<Index> controls_;    // one a component
};

}  // namespace der
