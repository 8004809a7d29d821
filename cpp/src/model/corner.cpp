#include "model/corner.hpp"

#include <algorithm>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "model/reference_rotation.hpp"

namespace der {

bool is_corner(const RodMesh& rod, Index place, const Model& model) {
  constexpr double kLeast = 0.1;  // [rad]
  // [rad]; a little more, so that rounding does not tell the nodes of a regular hexagon apart.
  constexpr double kSharp = kPi / 3.0 + 1e-9;
  constexpr double kAlone = 3.0;
  if (!bends_as_drawn(rod, model)) return false;
  if (rod.drawn_corners) {
    return rod.is_inner(place) && std::binary_search(rod.drawn_corners->begin(),
                                                     rod.drawn_corners->end(), rod.position(place));
  }
  const ReferenceRotation here = reference_rotation(rod, place, model);
  if (here.angle <= kLeast) return false;
  if (here.angle > kSharp) return true;
  const auto the_same_way = [&](Index beside) {
    const ReferenceRotation turn = reference_rotation(rod, beside, model);
    return turn.angle * turn.axis.dot(here.axis);
  };
  return here.angle > kAlone * std::max(the_same_way(place - 1), the_same_way(place + 1));
}

std::vector<Index> corners_of(const RodMesh& rod, const Model& model) {
  std::vector<Index> corners;
  for (Index place = 0; place < static_cast<Index>(rod.nodes.size()); ++place) {
    if (is_corner(rod, place, model)) corners.push_back(place);
  }
  return corners;
}

}  // namespace der
