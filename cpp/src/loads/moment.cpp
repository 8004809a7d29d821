#include <algorithm>
#include <cmath>

#include "der/energies/elements_of.hpp"
#include "der/energies/planar_moment.hpp"
#include "der/loads/circulatory.hpp"
#include "der/loads/loads.hpp"
#include "der/model/location.hpp"
#include "der/model/moment_place.hpp"

namespace der {
namespace {

/// Whether a support holds the tangent at arc length `s` [m].
bool is_clamped(const RodLayout& rod, double s) {
  return std::any_of(rod.clamps.begin(), rod.clamps.end(), [&](const Clamp& clamp) {
    return std::abs(rod.arc_length[static_cast<std::size_t>(clamp.place)] - s) <= rod.same_place();
  });
}

}  // namespace

void add_load(const scenario::Moment& load, const scenario::Scene& /*scene*/, Model& model) {
  RodLayout& rod = model.rod(load.rod);
  const double s = arc_length_of(load.at, rod);
  if (model.dimension == 3) {
    if (!is_clamped(rod, s)) {
      add_spatial_moment(load.moment_vector, load.follower, s, rod, model);
    }
    return;
  }
  const Index control = model.tables.add(load.moment);
  // The clamp takes it up; on the edges beside it, it would bend the rod by an error of order 1.
  if (is_clamped(rod, s)) return;
  MomentPlace& place = place_of_moments(s, rod);
  place.moments.push_back(control);
  auto& moments = elements_of<PlanarMoment>(*model.elements);
  for (std::size_t i = 0; i < place.weights.size(); ++i) {
    moments.add(rod.edge_dofs(place.first_edge + static_cast<Index>(i), model),
                {place.series_share(rod.EI) * place.weights[i], control});
  }
}

}  // namespace der
