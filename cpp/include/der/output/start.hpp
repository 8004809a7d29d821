#pragma once

#include "der/simulation.hpp"

namespace der {

/// Puts a new simulation where the scene's `start_from` says: into the equilibrium under the loads
/// at time 0, or into the last saved frame of a run folder (positions and velocities; the time
/// stays 0). Does nothing without that key. Throws NotConvergedError; IoError where the run cannot
/// be read or is one of other rods.
void apply_start(Simulation& simulation);

}  // namespace der
