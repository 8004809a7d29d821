#include "der/model/section_place.hpp"

#include <algorithm>

#include "der/model/location.hpp"
#include "der/model/moment_place.hpp"

namespace der {

SectionPlace section_place(double s, const RodLayout& rod) {
  const MomentPlace moments = moment_place(s, rod);
  SectionPlace place;
  place.first_edge = moments.first_edge;
  place.across = moments.weights;
  place.bend_cell = moments.cell_length;
  const double beyond = beyond_outer_middle(rod, s);
  if (moments.weights.size() == 1) {
    place.direction = place.along = {1.0};
    place.twist_cell = beyond;
    return place;
  }
  const double middle = rod.edge_middle(place.first_edge);
  const double spacing = rod.edge_middle(place.first_edge + 1) - middle;
  const double share = (s - middle) / spacing;
  const double inside = std::clamp(share, 0.0, 1.0);
  place.direction = {1.0 - share, share};
  place.along = {1.0 - inside, inside};
  place.twist_cell = beyond + inside * (1.0 - inside) * spacing;
  return place;
}

}  // namespace der
