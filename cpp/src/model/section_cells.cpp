#include "model/section_cells.hpp"

#include "der/core/index.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/section_spring.hpp"
#include "der/model/section_place.hpp"

namespace der {
namespace {

StoredBeside stored_by_moments(const RodMesh& rod, const Model& model, const Configuration& here) {
  StoredBeside total;
  for (const SpatialMomentPlace& place : rod.spatial_moments) {
    const auto stored = circulatory_loads(*model.elements)[to_size(place.load)].stored(here);
    total.in_rod += stored.in_rod;
    total.in_springs += stored.in_springs;
  }
  return total;
}

template <int Edges>
double stored_beside_spring(Index element, const Model& model, const Configuration& here) {
  using Kernel = SectionSpring<Edges>;
  const auto& springs = elements_of<Kernel>(*model.elements);
  const std::size_t number = to_size(element);
  return Kernel::stored_on_the_way(springs.constants[number], here,
                                   gather(springs.dofs[number], here.coordinates));
}

double stored_beside_springs(const RodMesh& rod, const Model& model, const Configuration& here) {
  double energy = 0.0;
  for (const SectionSpringPlace& spring : rod.section_springs) {
    energy += spring.on_one_edge ? stored_beside_spring<1>(spring.element, model, here)
                                 : stored_beside_spring<2>(spring.element, model, here);
  }
  return energy;
}

}  // namespace

Energies section_cell_energies(const RodMesh& rod, const Model& model, const Configuration& here) {
  Energies energies;
  const double beside_springs = stored_beside_springs(rod, model, here);
  const StoredBeside by_moments = stored_by_moments(rod, model, here);
  energies[EnergyTerm::Bend] = by_moments.in_rod + beside_springs;
  energies[EnergyTerm::Spring] = by_moments.in_springs - beside_springs;
  return energies;
}

double stored_by_section_moments(const Model& model, const Configuration& here) {
  double energy = 0.0;
  for (const RodMesh& rod : model.rods) {
    const StoredBeside stored = stored_by_moments(rod, model, here);
    energy += stored.in_rod + stored.in_springs;
  }
  return energy;
}

}  // namespace der
