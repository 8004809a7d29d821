#pragma once

#include <optional>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/statics/equilibrium_failure.hpp"
#include "statics/equilibrium/moment_turning.hpp"
#include "statics/equilibrium/shape.hpp"
#include "statics/equilibrium/static_loads.hpp"
#include "statics/equilibrium/static_newton.hpp"

namespace der::statics {

/// Pseudo-transient continuation (Kelley and Keyes, SIAM J. Numer. Anal. 35, 1998): implicit Euler
/// steps along the gradient flow x' = -grad(potential), with a pseudo-time step that grows as the
/// forces come into balance. Every step must lower the potential.
class PseudoTransient {
 public:
  /// Factor of the inverse pseudo-time step from one step to the next, where all goes well ...
  static constexpr double kDecay = 0.3;
  /// ... and near a saddle, where the potential is not convex.
  static constexpr double kDecayAtSaddle = 0.7;

  struct Result {
    double energy_change = 0.0;          ///< [J]
    std::optional<FailedSearch> failed;  ///< nothing if an equilibrium was reached
  };

  PseudoTransient(const Model& model, StaticNewton& newton);

  /// Moves `shape` to an equilibrium of lower potential, or as far on the way as it gets.
  /// `inverse_step` [N/m] is the inverse of the first pseudo-time step, for unit masses.
  Result run(const StaticLoads& loads, double inverse_step, Shape& shape, double decay = kDecay);

  /// Steps tried in all runs so far.
  [[nodiscard]] int steps() const { return steps_; }

 private:
  /// A step done: where it leads, and by how much the potential changes [J].
  struct Step {
    Vector positions;
    double energy_change = 0.0;
  };
  std::optional<Step> try_step(const StaticLoads& loads, const Shape& shape, double inverse_step,
                               std::optional<FailedSearch>& failed);

  const Model& model_;
  StaticNewton& newton_;
  PlanarMomentTurning turning_;
  int steps_ = 0;
};

}  // namespace der::statics
