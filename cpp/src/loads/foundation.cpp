#include "der/energies/foundation.hpp"

#include <algorithm>
#include <array>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/loads/loads.hpp"
#include "der/model/dimension.hpp"
#include "der/model/location.hpp"

namespace der {
namespace {

/// Integrals over a part of an edge of the products of its shape functions [m]. The functions are
/// linear: Simpson's rule has no error.
Eigen::Matrix2d shape_products(const EdgePart& part, const RodMesh& rod) {
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

template <int Dim>
void add_elements(const scenario::Foundation& load, const RodMesh& rod, Model& model) {
  using Kernel = Foundation<Dim>;
  for (const EdgePart& part : edge_parts(rod, load.from, load.to)) {
    std::array<Index, Kernel::kDofs> dofs{};
    for (Index c = 0; c < Dim; ++c) {
      dofs[to_size(c)] = model.dof(rod.node(part.edge), c);
      dofs[to_size(Dim + c)] = model.dof(rod.node(part.edge + 1), c);
    }
    typename Kernel::Constants constants;
    constants.stiffness = Eigen::Map<const Eigen::Matrix<double, Dim, 1>>(load.stiffness.data());
    constants.drawn = gather(dofs, model.initial_positions);
    constants.lengths = shape_products(part, rod);
    elements_of<Kernel>(*model.elements).add(dofs, constants);
  }
}

}  // namespace

// Nodes lie beside the curve by l^2/12 of its curvature, and edges as far on its other side in the
// mean: the linear interpolation has the displacement of the curve up to order 4.
void add_load(const scenario::Foundation& load, const LoadContext& /*context*/, Model& model) {
  RodMesh& rod = model.rod(load.rod);
  with_dimension(model, [&](auto dim) { add_elements<dim>(load, rod, model); });
  FoundationPlace place{load.from, load.to, {}};
  std::copy(load.stiffness.begin(), load.stiffness.end(), place.stiffness.begin());
  rod.foundation_places.push_back(place);
}

}  // namespace der
