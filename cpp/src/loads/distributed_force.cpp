#include "der/loads/dead_force.hpp"
#include "der/loads/loads.hpp"
#include "der/model/location.hpp"

namespace der {

// Consistent loads of the piecewise linear interpolation over the rest length.
void add_load(const scenario::DistributedForce& load, const LoadContext& context, Model& model) {
  RodMesh& rod = model.rod(load.rod);
  const DeadForce force(load.force, !context.name.empty(), model);
  for (const EdgePart& part : edge_parts(rod, load.from, load.to)) {
    const double at_last = length_at_last_end(part, rod);
    force.act_on(rod.node(part.edge), (part.to - part.from) - at_last, model);
    force.act_on(rod.node(part.edge + 1), at_last, model);
  }
  const std::array<Index, 3> controls = force.as_controls(model);
  rod.distributed_places.push_back({load.from, load.to, controls});
  if (!context.name.empty()) model.named.push_back(vector_control(context.name, "N/m", controls));
}

}  // namespace der
