#include <algorithm>
#include <cmath>

#include "der/loads/loads.hpp"
#include "der/model/location.hpp"
#include "der/supports/spring.hpp"

namespace der {
namespace {

/// Whether a support holds the tangent at arc length `s` [m].
bool is_clamped(const scenario::Scene& scene, const RodLayout& rod, double s) {
  const double same_place = 1e-9 * rod.rest_length();
  return std::any_of(scene.supports.begin(), scene.supports.end(),
                     [&](const scenario::Support& support) {
                       if (!support.clamp || support.rod != rod.name) return false;
                       return support.at.kind == scenario::Location::Kind::All ||
                              std::abs(arc_length_of(support.at, rod) - s) <= same_place;
                     });
}

}  // namespace

void add_load(const scenario::Moment& load, const scenario::Scene& scene, Model& model) {
  const RodLayout& rod = model.rod(load.rod);
  const Index control = model.controls.add(load.moment);
  auto& moments = std::get<ElementList<PlanarMoment>>(model.elements);
  const double s = arc_length_of(load.at, rod);
  // The clamp takes it up; on the edges beside it, it would bend the rod by an error of order 1.
  if (is_clamped(scene, rod, s)) return;
  const double share = moment_share(rod, s);
  for (const auto& [edge, weight] : edge_weights(rod, s)) {
    moments.add(rod.edge_dofs(edge, model), {share * weight, control});
  }
}

}  // namespace der
