#include "der/energies/held_force.hpp"

#include <array>

#include "der/energies/spatial_bend.hpp"

namespace der {

template <int Edges>
void HeldForce<Edges>::evaluate(const Configuration& here, const Vec3& amount,
                                CirculatoryTerm& out) const {
  out.reset(size());
  const auto free = this->response(here);
  const HeldSection held = free.held.under(this->load_before(here.controls));
  const SectionLoad drawn{Vec3::Zero(), this->reference_components(amount)};
  const Vec3 force = drawn.turned(held.section());
  out.force.template head<3>() = force;
  const std::array<Mat3, HeldSection::kMost> turning = held.turning();
  for (std::size_t i = 0; i < Edges; ++i) {
    out.tangent.template block<3, 4>(0, 3 + 4 * static_cast<Index>(i)) =
        cross_matrix(force) * turning[i] * free.edges[i].rotation();
  }
}

template struct HeldForce<1>;
template struct HeldForce<2>;

}  // namespace der
