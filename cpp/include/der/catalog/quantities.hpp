#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace der {

/// What a quantity belongs to, and so where a probe of it can stand.
enum class QuantityKind {
  Position,  ///< of the rod's points: any arc length
  Velocity,  ///< of the rod's points: any arc length
  Turn,      ///< of the nodes that bend: inner nodes, and ends that are clamped
  Bend,      ///< of the rod's bending: any arc length, with two values where moments jump
  Edge,      ///< of the edges: any arc length
  Energy,    ///< of a rod or of the whole model: no place
};

/// One row of the table of quantities that probes can record.
struct Quantity {
  std::string name;
  std::string unit;  ///< "" for a pure number
  QuantityKind kind;
  std::string doc;
};

const std::vector<Quantity>& quantities();
/// Null for an unknown name.
const Quantity* find_quantity(std::string_view name);

}  // namespace der
