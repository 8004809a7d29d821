#pragma once

#include <array>
#include <optional>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

namespace scenario {
struct Scene;
}

/// Velocity and acceleration of degrees of freedom that supports move, and the rates at which
/// clamps turn, at the end of a step.
///
/// Tables are straight between their entries, and a motion in pieces has no acceleration but at its
/// kinks. A table that samples a smooth motion has it in the mean: over the step before an instant
/// and one of the same length after it, to second order in the step. At the end of the run the
/// three steps before count, and everywhere where a program sets the motion, as what comes is not
/// known. Steps that are not equal move it evenly, without acceleration.
class HeldMotion {
 public:
  explicit HeldMotion(const scenario::Scene& scene);

  struct Rates {
    double velocity = 0.0;      ///< [m/s]
    double acceleration = 0.0;  ///< [m/s^2]
  };

  void evaluate(const Model& model, const State& state);
  /// At the state of the last `evaluate`.
  [[nodiscard]] Rates of(const HeldDof& held, const State& state) const;
  /// Rate [rad/s] of the control that turns a clamp, at the state of the last `evaluate`.
  [[nodiscard]] double turning_rate(Index control, const Model& model, const State& state) const;

 private:
  /// Those of a control; none where it goes evenly, as far as is known.
  [[nodiscard]] std::optional<Rates> of_control(Index control, const State& state) const;
  /// From the values at the end of the last step and so many before it.
  template <class At>
  [[nodiscard]] Rates after_steps(const At& at) const;
  /// Whether a ramp tells of the last three steps.
  [[nodiscard]] bool knows_past(const Ramp& ramp, const State& state) const;

  double duration_;  // [s]; 0: there is no time
  bool moves_ = false;
  bool at_end_ = false;
  double step_ = 0.0;
  std::array<Vector, 4> controls_;  // at one step after the instant and so many before
};

}  // namespace der
