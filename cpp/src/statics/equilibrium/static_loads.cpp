#include "statics/equilibrium/static_loads.hpp"

#include "der/statics/potential.hpp"

namespace der::statics {

StaticLoads scaled(const Model& model, const StaticLoads& loads, double share) {
  StaticLoads result = loads;
  result.force = share * loads.force;
  for (const auto& moment : std::get<ElementList<PlanarMoment>>(model.elements).constants) {
    result.controls[moment.moment] = share * loads.controls[moment.moment];
  }
  return result;
}

double energy_change(const Model& model, const StaticLoads& loads, const Shape& seen_from,
                     const Vector& from, const Vector& to) {
  return potential_change(model, loads.controls_of(model, seen_from), loads.force, from, to);
}

}  // namespace der::statics
