#pragma once

#include <vector>

#include "der/model/model.hpp"

namespace der {

/// Curvature [1/m] of a rod where no moment acts, at any arc length: what the scene gives at the
/// nodes, or what the drawn shape has, linear between the places where it is known and beyond them.
/// The turning angle of two drawn edges over their mean length is the curvature a third of their
/// difference beside their node.
class NaturalCurvature {
 public:
  NaturalCurvature(const RodLayout& rod, const Model& model);
  [[nodiscard]] double at(double s) const;

 private:
  std::vector<double> arc_length_;  // [m]
  std::vector<double> values_;      // [1/m]
};

}  // namespace der
