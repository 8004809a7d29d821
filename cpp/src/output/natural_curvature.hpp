#pragma once

#include <vector>

#include "der/model/model.hpp"

namespace der {

/// Curvature [1/m] of a rod where no moment acts, at any arc length: the values of the
/// scene at the nodes, or those of the initial shape, interpolated and extrapolated linearly.
/// The turning angle of two initial edges over their mean length is the curvature a third of their
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
