#include <algorithm>

#include "der/loads/dead_force.hpp"
#include "der/loads/loads.hpp"

namespace der {

// Consistent loads of the piecewise linear interpolation over the rest length.
void add_load(const scenario::DistributedForce& load, const scenario::Scene& /*scene*/,
              Model& model) {
  RodLayout& rod = model.rod(load.rod);
  const DeadForce force(load.force, model);
  for (std::size_t i = 0; i + 1 < rod.nodes.size(); ++i) {
    const double s0 = rod.arc_length[i];
    const double s1 = rod.arc_length[i + 1];
    const double a = std::max(load.from, s0);
    const double b = std::min(load.to, s1);
    if (a >= b) continue;
    const double right = DistributedPlace::share_of_end(a, b, s0, s1);
    force.act_on(rod.nodes[i], (b - a) - right, model);
    force.act_on(rod.nodes[i + 1], right, model);
  }
  rod.distributed_places.push_back({load.from, load.to, force.as_controls(model)});
}

}  // namespace der
