#include "der/loads/loads.hpp"
#include "der/model/location.hpp"
#include "der/supports/spring.hpp"

namespace der {

void add_load(const scenario::Moment& load, const scenario::Scene& /*scene*/, Model& model) {
  const RodLayout& rod = model.rod(load.rod);
  const Index control = model.controls.add(load.moment);
  auto& moments = std::get<ElementList<PlanarMoment>>(model.elements);
  const double s = arc_length_of(load.at, rod);
  const double share = moment_share(rod, s);
  for (const auto& [edge, weight] : edge_weights(rod, s)) {
    moments.add(rod.edge_dofs(edge, model), {share * weight, control});
  }
}

}  // namespace der
