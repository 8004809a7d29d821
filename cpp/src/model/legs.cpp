#include "model/legs.hpp"

#include <algorithm>

#include "model/corner.hpp"

namespace der {

std::vector<Index> leg_bounds(const RodMesh& rod, const Model& model) {
  std::vector<Index> bounds = corners_of(rod, model);
  for (const CurvatureJump& jump : rod.natural_jumps) bounds.push_back(jump.place);
  std::sort(bounds.begin(), bounds.end());
  return bounds;
}

}  // namespace der
