#pragma once

#include <cstdint>
#include <string>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// Detects runs whose time integrator creates energy.
///
/// The measure is the ratio of the energy created to the energy exchanged in the run. The latter is
/// the largest kinetic energy, or work of loads, supports or drag, less what was created by then.
/// From 1/20 on the result is marked as unreliable; from 1/2 on the run has failed. (No correct run
/// in configs/, with any stepper, creates as much as 1/200; no wrong one as little as 1/4.) A check
/// costs a fifteenth of an implicit step and half of an explicit one, so only every sixteenth
/// implicit step and every sixty-fourth explicit one is checked. Energy that a program adds by
/// writing into the state between two steps is counted separately.
///
/// A node that turns through half a turn is another reason for doubt: the turning angle, and with
/// it the bending energy of a rod with a natural shape or a moment, jumps there by a whole turn.
class EnergyMonitor {
 public:
  /// Number of implicit steps from one check to the next.
  static constexpr std::int64_t kStride = 16;

  explicit EnergyMonitor(const Model& model);

  /// To be called at the start of a motion, whose energy is the reference.
  void begin(const State& state);
  /// Whether a program has written positions since the last step.
  [[nodiscard]] bool has_written_shape(const State& state) const;
  /// Whether angles of sections are among these.
  [[nodiscard]] bool has_written_angles(const State& state) const;
  /// Whether it has written positions or velocities.
  [[nodiscard]] bool has_external_writes(const State& state) const;
  /// The energy [J] of a state before a program wrote into it, as long as it follows nothing that
  /// was written.
  [[nodiscard]] double energy_before_writes(const State& state);
  /// To be called before a step of such a state, once it follows what was written: accumulates the
  /// energy of that.
  void enter_written(double before, State& state);
  /// To be called after each step: enters a node that has folded over in it. Allocates nothing.
  void after_step(State& state);
  /// Enters the energies of the present state into its audit.
  void look(State& state) { enter_energies(energies_of(state), state); }
  [[nodiscard]] Energies energies_of(const State& state);
  void enter_energies(const Energies& now, State& state) const;

 private:
  void keep(const State& state);

  const Model& model_;
  double rounding_;  // [J] of the energies
  Configuration here_;
  Vector positions_;   // as the last step has left them
  Vector velocities_;  // likewise
};

/// Whether the time stepping has created more than a share of what the run exchanges.
bool is_doubtful(const EnergyAudit& audit);
bool is_unstable(const EnergyAudit& audit);

/// "the integrator created 7.4e+05 J, twice the energy exchanged in the run (3.7e+05 J)", or which
/// node folded over, or both; empty if there is no reason for doubt.
std::string describe(const Model& model, const EnergyAudit& audit);

}  // namespace der
