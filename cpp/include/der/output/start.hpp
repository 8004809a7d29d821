#pragma once

#include "der/simulation.hpp"

namespace der {

/// Puts a new simulation where the scene's `start_from` says: into the equilibrium under the loads
/// at time 0, or into the last saved frame of a run folder: positions, but for those that supports
/// hold, and velocities. The time stays 0, and the energy ledger starts there. Does nothing without
/// that key. Throws NotConvergedError; IoError, which names the key, where the run cannot be read
/// or is one of rods with other names, nodes or rest lengths; Error
/// ("unstable_step") where an explicit step is too long for that start. `beat` is called at least
/// once an iteration of a search.
void apply_start(Simulation& simulation, const CancelCallback& beat = {});

}  // namespace der
