#pragma once

#include "der/core/types.hpp"
#include "der/energies/circulatory_term.hpp"
#include "der/energies/loaded_section.hpp"
#include "der/kinematics/configuration.hpp"

namespace der {

/// A force that turns with a section that its edges do not tell (LoadedSection), under all moments
/// at the place. Local coordinates: the point, then the vector and the angle of each edge.
template <int Edges>
struct HeldForce : LoadedSection<Edges> {
  [[nodiscard]] Index size() const { return 3 + 4 * Edges; }
  /// `amount` is the force in the initial shape [N].
  void evaluate(const Configuration& here, const Vec3& amount, CirculatoryTerm& out) const;
};

}  // namespace der
