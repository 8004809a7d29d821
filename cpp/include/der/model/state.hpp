#pragma once

#include <cstdint>
#include <vector>

#include "der/core/types.hpp"

namespace der {

struct Model;

/// Everything that changes in a run. A plain value: copy it to save it, assign it to go back, bit
/// for bit. Vectors have one entry a degree of freedom.
struct State {
  double time = 0.0;      ///< [s]
  std::int64_t step = 0;  ///< steps of the scene done
  Vector positions;       ///< [m]
  Vector velocities;      ///< [m/s]
  Vector extra_force;     ///< [N] set from outside (a controller); constant during a step
  /// [m/s^2] as the stepper knows it: part of the method for some, a better first guess for others.
  Vector accelerations;
  double last_step = 0.0;  ///< [s] length of the last step; 0: no step yet, `accelerations` not set
  std::vector<Vector> history;  ///< what a multi-step stepper remembers besides
};

/// The state at time 0.
State initial_state(const Model& model);

/// Energies [J] of a state.
struct Energies {
  double kinetic = 0.0;
  double stretch = 0.0;
  double bend = 0.0;
  double gravity = 0.0;  ///< of the weight, zero at the origin
  [[nodiscard]] double elastic() const { return stretch + bend; }
  [[nodiscard]] double total() const { return kinetic + elastic() + gravity; }
};
Energies energies(const Model& model, const State& state);

}  // namespace der
