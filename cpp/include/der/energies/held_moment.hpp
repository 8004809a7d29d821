#pragma once

#include <optional>

#include "der/core/types.hpp"
#include "der/energies/circulatory_term.hpp"
#include "der/energies/edge_moments.hpp"
#include "der/energies/loaded_section.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A moment M on a section that its edges do not tell (LoadedSection). It acts on the section
/// itself: on the edges, as a SpatialMoment, it would turn the section too far by what springs keep
/// from it, or about other axes than those of the rod on the way, an error of order 1. One that
/// follows turns with this section.
///
/// Springs have an element of their own (SectionSpring), without a moment. The load is the change
/// of that element's forces by M, beyond that by the moments before it. Local coordinates: the
/// vector and the angle of each edge.
template <int Edges>
struct HeldMoment : LoadedSection<Edges> {
  using Kernel = SectionSpring<Edges>;
  bool follower = false;

  [[nodiscard]] Index size() const { return 4 * Edges; }
  /// The number in `edges` of that which is nearer.
  [[nodiscard]] std::size_t nearer() const {
    return this->section.edges[0].weights(0, 0) < 0.5 ? Edges - 1 : 0;
  }
  /// `amount` is M, or M0 in the initial shape [N m], here and below. The whole is what the rod
  /// takes more than without the moment: M less what the springs take of it.
  [[nodiscard]] EdgeMoments moments_at(const Configuration& here, const Vec3& amount) const;
  /// The change [N m] of the moment that the springs exert.
  [[nodiscard]] Vec3 taken_by_springs(const Configuration& here, const Vec3& amount) const;
  /// HeldSection::axes_of_springs, under this moment and those before it.
  [[nodiscard]] Mat3 axes_of_springs(const Configuration& here, const Vec3& amount) const;
  void evaluate(const Configuration& here, const Vec3& amount, CirculatoryTerm& out) const;
  [[nodiscard]] StoredBeside stored(const Configuration& here, const Vec3& amount) const;

 private:
  /// The section without the moment and with it.
  struct Change {
    typename Kernel::Response free;
    HeldSection before;
    HeldSection after;
    /// Tangent of a clamp that lets the section spin. Of what the clamp would take, it bears no
    /// torque about that tangent: the edge has this torque about its own.
    std::optional<Vec3> spins_about;

    Change(const HeldMoment& moment, const Configuration& here, const Vec3& amount);
    /// Change of HeldSection::moment.
    [[nodiscard]] Vec3 on_carried(std::size_t i) const {
      return after.moment(i) - before.moment(i);
    }
    /// The torque [N m] that the clamp does not bear.
    [[nodiscard]] double passed_on() const {
      return spins_about ? spins_about->dot(on_carried(kClamp)) : 0.0;
    }
    [[nodiscard]] Vec3 on_edge(std::size_t i) const {
      return on_carried(i) + passed_on() * free.edges[i].frame.tangent;
    }
    [[nodiscard]] Vec3 on_rod() const;
  };
  /// The number of a clamp among the carried sections, behind the one edge beside it.
  static constexpr std::size_t kClamp = 1;
  [[nodiscard]] SectionLoad load_with(const Vector& controls, const Vec3& amount) const;
};

}  // namespace der
