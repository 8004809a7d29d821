#include "der/loads/loads.hpp"

namespace der {

void add_load(const scenario::Damping& load, const LoadContext& /*context*/, Model& model) {
  for (const RodMesh& rod : model.rods) {
    if (load.rod && *load.rod != rod.name) continue;
    for (std::size_t i = 0; i < rod.nodes.size(); ++i) {
      const double coefficient = load.coefficient * rod.voronoi_length(static_cast<Index>(i));
      for (int c = 0; c < model.dimension; ++c) {
        model.damping[model.dof(rod.nodes[i], c)] += coefficient;
      }
    }
  }
}

}  // namespace der
