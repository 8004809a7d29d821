#include "der/loads/loads.hpp"
#include "der/model/location.hpp"

namespace der {

void add_load(const scenario::Moment& load, const scenario::Scene& /*scene*/, Model& model) {
  const RodLayout& rod = model.rod(load.rod);
  const Index control = model.controls.add(load.moment);
  auto& moments = std::get<ElementList<PlanarMoment>>(model.elements);
  for (const auto& [edge, share] : edge_weights(rod, arc_length_of(load.at, rod))) {
    moments.add(rod.edge_dofs(edge, model), {share, control});
  }
}

}  // namespace der
