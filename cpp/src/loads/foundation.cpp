#include "der/energies/foundation.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/loads/loads.hpp"
#include "der/model/location.hpp"

namespace der {
namespace {

/// Integrals over a part of an edge of the products of its shape functions [m]. The functions are
/// linear: Simpson's rule has no error.
Eigen::Matrix2d shape_products(const EdgePart& part, const RodLayout& rod) {
  const double s0 = rod.arc_length_at(part.edge);
  const double s1 = rod.arc_length_at(part.edge + 1);
  const auto at = [&](double s) {
    const double share = (s - s0) / (s1 - s0);
    const Vec2 shapes{1.0 - share, share};
    return Eigen::Matrix2d(shapes * shapes.transpose());
  };
  const auto& [edge, a, b] = part;
  return (b - a) / 6.0 * (at(a) + 4.0 * at(0.5 * (a + b)) + at(b));
}

}  // namespace

// Nodes lie beside the curve by l^2/12 of its curvature, and edges as far on its other side in the
// mean: the linear interpolation has the displacement of the curve up to order 4.
void add_load(const scenario::Foundation& load, const scenario::Scene& /*scene*/, Model& model) {
  RodLayout& rod = model.rod(load.rod);
  const Eigen::Map<const Vec2> stiffness(load.stiffness.data());
  auto& elements = elements_of<Foundation>(*model.elements);
  for (const EdgePart& part : edge_parts(rod, load.from, load.to)) {
    const auto dofs = rod.edge_dofs(part.edge, model);
    Foundation::Constants constants;
    constants.stiffness = stiffness;
    constants.drawn = gather(dofs, model.initial_positions);
    constants.lengths = shape_products(part, rod);
    elements.add(dofs, constants);
  }
  rod.foundation_places.push_back({load.from, load.to, stiffness});
}

}  // namespace der
