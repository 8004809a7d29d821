#pragma once

#include <vector>

#include "der/kinematics/natural_strain_offset.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// The change that actuations make to the rest shape of one element, at a state.
class ActuatedRest {
 public:
  ActuatedRest() = default;
  ActuatedRest(const NaturalStrainOffset& shift, Index size, const Model& model);
  /// Entry number `i` of the shift: an extension [m] or turning angle, or two integrated curvatures
  /// and a twist.
  [[nodiscard]] double value(Index i, const Model& model, const State& state) const;
  [[nodiscard]] Vec3 strains(const Model& model, const State& state) const;

 private:
  std::vector<NaturalStrain::Term> terms_;  // entries counted from that of the shift
};

/// The natural curvatures and twist that actuations give a rod, at any place.
class ActuatedShape {
 public:
  explicit ActuatedShape(const RodMesh& rod) : stretches_(rod.actuated_stretches) {}

  /// Right before arc length `s` [m], or right after it [1/m]: in a plane the first component is
  /// the curvature, in space they are those towards the two directors and the twist.
  [[nodiscard]] Vec3 strains(double s, bool before, const Model& model, const State& state) const;

  /// Whether any actuation bends or twists the rod.
  [[nodiscard]] bool is_strained() const;

 private:
  std::vector<ActuatedStretch> stretches_;
};

/// Arc lengths [m] at which an actuation lets the curvature of a rod jump, within it; with `twists`
/// also those at which its twist jumps.
std::vector<double> actuated_jumps(const RodMesh& rod, bool twists);

/// Whether an actuation lets the curvature or the twist of a ring jump at its start: it has two
/// values there.
bool actuation_jumps_at_start(const RodMesh& rod);

/// Whether one of `actuated_jumps` is inside an edge.
bool actuation_jumps_in(Index edge, const RodMesh& rod, bool twists);

}  // namespace der
