#include "der/loads/loads.hpp"
#include "der/model/location.hpp"
#include "der/model/moment_place.hpp"

namespace der {

void add_load(const scenario::Moment& load, const scenario::Scene& /*scene*/, Model& model) {
  RodLayout& rod = model.rod(load.rod);
  const Index control = model.controls.add(load.moment);
  MomentPlace& place = place_of_moments(arc_length_of(load.at, rod), rod);
  place.moments.push_back(control);
  auto& moments = std::get<ElementList<PlanarMoment>>(model.elements);
  for (std::size_t i = 0; i < place.weights.size(); ++i) {
    moments.add(rod.edge_dofs(place.first_edge + static_cast<Index>(i), model),
                {place.series_share(rod.EI) * place.weights[i], control});
  }
}

}  // namespace der
