#include "der/model/section_place.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/model/location.hpp"
#include "der/model/moment_place.hpp"

namespace der {

SectionPlace section_place(double s, const RodMesh& rod) {
  const MomentPlace moments = moment_place(s, rod);
  SectionPlace place;
  place.first_edge = moments.first_edge;
  place.across = moments.weights;
  place.bend_cell = moments.cell_length;
  const double beyond = beyond_outer_middle(rod, s);
  if (const auto beside = place_beside_clamp(rod, s)) {
    // Without a hold on the section the edge alone has the twist.
    const double half = 0.5 * rod.edge_length[to_size(beside->edge)];
    const bool held = rod.clamps[to_size(beside->clamp)].holds_section;
    // Beyond the edge's middle, up to where a clamp reaches in bending, more than 1: the edges
    // behind it then have the twist that the torque makes on its way, and only this one has not.
    const double twisted = held ? beside->distance / half : 1.0;
    place.direction = {1.0};
    place.along = {twisted};
    place.twist_cell =
        std::max(0.0, held ? twisted * (1.0 - twisted) * half : half - beside->distance);
    return place;
  }
  if (moments.weights.size() == 1) {
    place.direction = place.along = {1.0};
    place.twist_cell = beyond;
    return place;
  }
  const auto share_between = [s](double first, double last) {
    return (s - first) / (last - first);
  };
  const double middle = rod.edge_middle(place.first_edge);
  const double next_middle = rod.edge_middle(place.first_edge + 1);
  const double share =
      share_between(tangent_place(rod, place.first_edge), tangent_place(rod, place.first_edge + 1));
  const double inside = std::clamp(share_between(middle, next_middle), 0.0, 1.0);
  const double spacing = next_middle - middle;
  place.direction = {1.0 - share, share};
  place.along = {1.0 - inside, inside};
  place.twist_cell = beyond + inside * (1.0 - inside) * spacing;
  return place;
}

}  // namespace der
