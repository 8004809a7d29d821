#include "statics/equilibrium/static_loads.hpp"

#include "der/energies/circulatory_load.hpp"
#include "der/energies/planar_moments.hpp"
#include "der/statics/potential.hpp"

namespace der::statics {

StaticLoads scaled(const Model& model, const StaticLoads& loads, double share) {
  StaticLoads result = loads;
  result.force = share * loads.force;
  for_each_planar_moment(*model.elements, [&](const auto& /*dofs*/, const auto& moment) {
    result.controls[moment.moment] = share * loads.controls[moment.moment];
  });
  for (const CirculatoryLoad& load : circulatory_loads(*model.elements)) {
    for (const Index control : load.amount.components) {
      if (control >= 0) result.controls[control] = share * loads.controls[control];
    }
  }
  return result;
}

bool is_unloaded(const Model& model, const StaticLoads& loads) {
  const StaticLoads none = scaled(model, loads, 0.0);
  return none.force == loads.force && none.controls == loads.controls;
}

double energy_change(const Model& model, const StaticLoads& loads, const Shape& seen_from,
                     const Vector& from, const Vector& to) {
  return potential_change(model, loads.force, loads.at(model, {from, seen_from.followed}), to);
}

}  // namespace der::statics
