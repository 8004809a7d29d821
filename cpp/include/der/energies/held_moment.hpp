#pragma once

#include <array>
#include <vector>

#include "der/core/types.hpp"
#include "der/energies/circulatory_term.hpp"
#include "der/energies/edge_moments.hpp"
#include "der/energies/framed_edge.hpp"
#include "der/energies/section_spring.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A moment M on a section that springs against turning hold at the same place, or at a corner,
/// where the rod on the two sides bends about other axes. It acts on the section itself, which
/// turns against the edges as the rod on the way bends (HeldSection): on the edges, as a
/// SpatialMoment, it would turn the section too far by what the springs, or the other axes, keep
/// from it, an error of order 1. One that follows turns with this section.
///
/// The springs have an element of their own (SectionSpring), without a moment. The load is the
/// change of that element's forces by the moment. Local coordinates: the vector and the angle of
/// each edge.
template <int Edges>
struct HeldMoment {
  using Kernel = SectionSpring<Edges>;
  std::vector<FramedEdge> edges;
  typename Kernel::Constants section;  ///< without springs of stiffness 0
  bool follower = false;

  [[nodiscard]] Index size() const { return 4 * Edges; }
  /// The number in `edges` of that which is nearer.
  [[nodiscard]] std::size_t nearer() const {
    return section.edges[0].weights(0, 0) < 0.5 ? Edges - 1 : 0;
  }
  /// `amount` is M, or M0 in the initial shape [N m], here and below. The whole is what the rod
  /// takes more than without the moment: M less what the springs take of it.
  [[nodiscard]] EdgeMoments moments(const Configuration& here, const Vec3& amount) const;
  /// The change [N m] of the moment that the springs exert.
  [[nodiscard]] Vec3 taken_by_springs(const Configuration& here, const Vec3& amount) const;
  void evaluate(const Configuration& here, const Vec3& amount, CirculatoryTerm& out) const;
  [[nodiscard]] StoredBeside stored(const Configuration& here, const Vec3& amount) const;

 private:
  /// The section without the moment and with it.
  struct Change {
    typename Kernel::Response free;
    HeldSection loaded;

    Change(const typename Kernel::Constants& section, const Configuration& here,
           const Eigen::Matrix<double, Kernel::kDofs, 1>& x, const SectionLoad& load)
        : free(section, here, x), loaded(free.held.under(load)) {}
    [[nodiscard]] Vec3 moment(std::size_t i) const {
      return loaded.moment(i) - free.held.moment(i);
    }
    [[nodiscard]] Vec3 on_rod() const;
  };
  [[nodiscard]] Change change_at(const Configuration& here, const Vec3& amount) const;
};

}  // namespace der
