#pragma once

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/steppers/stepper.hpp"

namespace der {

/// What every explicit stepper shares: the acceleration of a given state, the motion of held
/// degrees of freedom, and the check that the motion has not blown up.
class ExplicitForce {
 public:
  ExplicitForce(const Model& model, const Assembler& assembler);

  /// Sets `acceleration` [m/s^2] to M^-1 (external - grad E) at `time`, 0 on held degrees of
  /// freedom.
  void undamped_acceleration(const State& state, const Vector& positions, double time,
                             Vector& acceleration);
  /// As above, with the damping force -C v.
  void acceleration(const State& state, const Vector& positions, const Vector& velocities,
                    double time, Vector& acceleration);
  /// Puts held degrees of freedom of `positions` where the tables have them at `time`.
  void place_held_at(double time, Vector& positions);
  /// Not done where a value is no longer a number or an edge is stretched beyond reason.
  [[nodiscard]] StepReport check(const Vector& positions) const;

 private:
  const Model& model_;
  const Assembler& assembler_;
  Vector controls_;
  Vector force_;
  Vector gradient_;
};

}  // namespace der
