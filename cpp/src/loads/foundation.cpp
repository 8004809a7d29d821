#include <algorithm>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/foundation.hpp"
#include "der/loads/loads.hpp"

namespace der {
namespace {

/// Integrals over [a, b] of the products of the shape functions of an edge from s0 to s1 [m]. The
/// functions are linear: Simpson's rule has no error.
Eigen::Matrix2d shape_products(double a, double b, double s0, double s1) {
  const auto at = [&](double s) {
    const double share = (s - s0) / (s1 - s0);
    const Vec2 shapes{1.0 - share, share};
    return Eigen::Matrix2d(shapes * shapes.transpose());
  };
  return (b - a) / 6.0 * (at(a) + 4.0 * at(0.5 * (a + b)) + at(b));
}

}  // namespace

// Nodes lie beside the curve by l^2/12 of its curvature, and edges as far on its other side in the
// mean: the linear interpolation has the displacement of the curve up to order 4.
void add_load(const scenario::Foundation& load, const scenario::Scene& /*scene*/, Model& model) {
  const RodLayout& rod = model.rod(load.rod);
  auto& elements = elements_of<Foundation>(*model.elements);
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    const double s0 = rod.arc_length[to_size(edge)];
    const double s1 = rod.arc_length[to_size(edge + 1)];
    const double a = std::max(load.from, s0);
    const double b = std::min(load.to, s1);
    if (a >= b) continue;
    const auto dofs = rod.edge_dofs(edge, model);
    Foundation::Constants constants;
    constants.stiffness = Eigen::Map<const Vec2>(load.stiffness.data());
    constants.drawn = gather(dofs, model.initial_positions);
    constants.start = (a - s0) / (s1 - s0);
    constants.end = (b - s0) / (s1 - s0);
    constants.lengths = shape_products(a, b, s0, s1);
    elements.add(dofs, constants);
  }
}

}  // namespace der
